//! Lists serial ports on Windows and macOS.

use crate::ListedPort;
use serialport::SerialPortType;
use std::io;

/// Lists the USB serial ports, in the order of their names.
///
/// # Errors
/// If the system's list of ports cannot be read.
pub fn list_ports() -> io::Result<Vec<ListedPort>> {
    let ports = serialport::available_ports()?.into_iter();
    let usb = ports.filter_map(|port| match port.port_type {
        SerialPortType::UsbPort(usb) => Some(ListedPort {
            path: port.port_name,
            product: usb.product.unwrap_or_default(),
        }),
        _ => None,
    });
    let mut ports: Vec<_> = usb.collect();
    ports.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(ports)
}
