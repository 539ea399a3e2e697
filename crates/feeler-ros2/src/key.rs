//! Zenoh keys of topics and services.

/// Returns the key of a topic or service: `<domain>/<name>/<DDS type>/<hash>`. `type_name` is a ROS 2 name such as
/// `sensor_msgs/msg/JointState`; `hash` begins with `RIHS01_`.
pub fn key(domain: u32, whole_name: &str, type_name: &str, hash: &str) -> String {
    let name = whole_name.trim_matches('/');
    format!("{domain}/{name}/{}/{hash}", dds_type(type_name))
}

/// Converts a type's ROS 2 name to its DDS name, such as `sensor_msgs::msg::dds_::JointState_`.
pub fn dds_type(type_name: &str) -> String {
    match type_name.rsplit_once('/') {
        Some((package, name)) => format!("{}::dds_::{name}_", package.replace('/', "::")),
        None => format!("{type_name}_"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_match_rmw_zenoh() {
        let made = key(
            2,
            "/finger_0/wrench",
            "geometry_msgs/msg/WrenchStamped",
            "RIHS01_ab",
        );
        assert_eq!(
            made,
            "2/finger_0/wrench/geometry_msgs::msg::dds_::WrenchStamped_/RIHS01_ab"
        );
    }
}
