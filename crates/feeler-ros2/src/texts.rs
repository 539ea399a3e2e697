//! Message texts from the files in `msg/`.

/// Concatenates the texts of `msg/<name>.msg`, each with a header that names its type: the part of a message text that
/// follows the type's own fields.
macro_rules! texts {
    ($($name:literal),* $(,)?) => {
        concat!($(
            "================================================================================\n",
            "MSG: ", $name, "\n",
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/msg/", $name, ".msg")),
        )*)
    };
}

/// Implements `Message` for a struct, from its ROS 2 name, its own text, and the names of all nested types.
macro_rules! ros_message {
    ($type:ty, $name:literal, $own:expr $(, $part:literal)* $(,)?) => {
        impl feeler_record::wire::Message for $type {
            const SCHEMA_NAME: &'static str = $name;
            const SCHEMA: &'static str = concat!($own, texts!($($part),*));
        }
    };
}
