//! Message texts from the files under `msg/`.

/// The texts of `msg/<name>.msg`, each behind a line that says whose it is: what stands after the text of a type that uses them.
macro_rules! texts {
    ($($name:literal),* $(,)?) => {
        concat!($(
            "================================================================================\n",
            "MSG: ", $name, "\n",
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/msg/", $name, ".msg")),
        )*)
    };
}

/// Implements `Message` for a struct: its name in ROS 2, its own text, and the names of all types that it is made of.
macro_rules! ros_message {
    ($type:ty, $name:literal, $own:expr $(, $part:literal)* $(,)?) => {
        impl feeler_record::wire::Message for $type {
            const SCHEMA_NAME: &'static str = $name;
            const SCHEMA: &'static str = concat!($own, texts!($($part),*));
        }
    };
}
