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
    ($type:ty, $name:expr, $own:expr $(, $part:literal)* $(,)?) => {
        impl feeler_record::wire::Message for $type {
            const SCHEMA_NAME: &'static str = $name;
            const SCHEMA: &'static str = concat!($own, texts!($($part),*));
        }
    };
}

/// Defines a service, given its ROS 2 name, and implements `Message` for its request and response, each given with the
/// text of its fields and the names of all nested types.
macro_rules! ros_service {
    (
        $(#[$doc:meta])*
        $service:ident = $name:literal,
        $request:ty: $asked:literal $(, $asked_part:literal)*;
        $response:ty: $answered:literal $(, $answered_part:literal)* $(,)?
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub enum $service {}

        impl crate::type_description::Service for $service {
            const NAME: &'static str = $name;
            type Request = $request;
            type Response = $response;
        }

        ros_message!($request, concat!($name, "_Request"), $asked $(, $asked_part)*);
        ros_message!($response, concat!($name, "_Response"), $answered $(, $answered_part)*);
    };
}
