//! Lists serial ports on Linux, found in sysfs.

use crate::ListedPort;
use std::fs;
use std::io;
use std::path::Path;

/// Folder of all terminals.
const TERMINALS: &str = "/sys/class/tty";

/// Lists the USB serial ports, in the order of their names. Ports of the main board are not listed, because most of
/// them are not connected.
///
/// # Errors
/// If the system's list of terminals cannot be read.
pub fn list_ports() -> io::Result<Vec<ListedPort>> {
    ports_in(Path::new(TERMINALS))
}

fn ports_in(terminals: &Path) -> io::Result<Vec<ListedPort>> {
    let mut ports = Vec::new();
    for entry in fs::read_dir(terminals)? {
        let entry = entry?;
        let device = entry.path().join("device");
        if is_usb(&device) {
            ports.push(ListedPort {
                path: format!("/dev/{}", entry.file_name().to_string_lossy()),
                product: product(&device),
            });
        }
    }
    ports.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(ports)
}

/// Returns `true` if a terminal's device is on USB: an interface of a USB device, or a USB serial converter.
fn is_usb(device: &Path) -> bool {
    let subsystem = fs::canonicalize(device.join("subsystem"));
    subsystem.is_ok_and(|path| path.ends_with("usb") || path.ends_with("usb-serial"))
}

/// Product name of the USB device that contains `device`; empty if it has none.
fn product(device: &Path) -> String {
    let Ok(device) = fs::canonicalize(device) else {
        return String::new();
    };
    let mut parents = device.ancestors().take(4);
    let name = parents.find_map(|parent| fs::read_to_string(parent.join("product")).ok());
    name.unwrap_or_default().trim().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    /// Creates the terminal `name` of a device in `folder` whose subsystem is called `subsystem`.
    fn terminal(root: &Path, name: &str, folder: &str, subsystem: &str) {
        let device = root.join("devices").join(folder);
        let subsystem = root.join("bus").join(subsystem);
        fs::create_dir_all(&device).unwrap();
        fs::create_dir_all(&subsystem).unwrap();
        symlink(subsystem, device.join("subsystem")).unwrap();
        let terminal = root.join("tty").join(name);
        fs::create_dir_all(&terminal).unwrap();
        symlink(device, terminal.join("device")).unwrap();
    }

    #[test]
    fn lists_usb_ports_with_their_products() {
        let root = std::env::temp_dir().join(format!("feeler-serial-list-{}", std::process::id()));
        let _ = fs::remove_dir_all(&root);
        terminal(&root, "ttyUSB0", "usb1/1-2/1-2:1.0/ttyUSB0", "usb-serial");
        terminal(&root, "ttyACM0", "usb1/1-1/1-1:1.0", "usb");
        terminal(&root, "ttyS0", "platform/serial8250", "platform");
        fs::create_dir_all(root.join("tty/tty0")).unwrap();
        fs::write(root.join("devices/usb1/1-1/product"), "QT Py M0\n").unwrap();
        let ports = ports_in(&root.join("tty")).unwrap();
        let port = |path: &str, product: &str| ListedPort {
            path: path.into(),
            product: product.into(),
        };
        assert_eq!(
            ports,
            [port("/dev/ttyACM0", "QT Py M0"), port("/dev/ttyUSB0", "")]
        );
        fs::remove_dir_all(&root).unwrap();
    }
}
