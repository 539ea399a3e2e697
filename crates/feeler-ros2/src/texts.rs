//! Macros that build message texts from the files in `msg/`.

/// Concatenates the files `msg/<name>.msg`, each under a header with its type's name. In a message text, these
/// definitions of nested types follow the message's own fields.
macro_rules! texts {
    ($($name:literal),* $(,)?) => {
        concat!($(
            "================================================================================\n",
            "MSG: ", $name, "\n",
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/msg/", $name, ".msg")),
        )*)
    };
}

/// Implements `Message` for a struct, given its ROS 2 name, the text of its fields, and the names of all nested types.
macro_rules! ros_message {
    ($type:ty, $name:literal, $own:expr $(, $part:literal)* $(,)?) => {
        impl feeler_record::wire::Message for $type {
            const SCHEMA_NAME: &'static str = $name;
            const SCHEMA: &'static str = concat!($own, texts!($($part),*));
        }
    };
}
