//! Definition of a message: its struct and its ROS 2 message text, from the same fields and comments.

/// Returns the ROS 2 name of a field's type.
#[rustfmt::skip]
macro_rules! ros_type {
    (bool) => { "bool" };
    (u8) => { "uint8" };
    (i32) => { "int32" };
    (u32) => { "uint32" };
    (u64) => { "uint64" };
    (f64) => { "float64" };
    ([f64; MAX_FINGERS]) => { "float64[5]" };
    (String) => { "string" };
    (ProgramKind) => { "string" };
    (Vector3) => { "geometry_msgs/Vector3" };
    (Quaternion) => { "geometry_msgs/Quaternion" };
    (MessageHeader) => { "feeler_msgs/Header" };
    (StopInForce) => { "feeler_msgs/StopInForce" };
    (InstrumentsMessage) => { "feeler_msgs/Instruments" };
    (Vec $element:tt) => { concat!(ros_type!($element), "[]") };
}

/// Returns the ROS 2 name of a field.
macro_rules! field_name {
    (r#move) => {
        "move"
    };
    ($field:ident) => {
        stringify!($field)
    };
}

/// Defines a message with the given ROS 2 name. It may have `constants`, and its text ends `with` the texts of all
/// nested types.
macro_rules! message {
    (@struct $(#[$meta:meta])+ $type:ident {
        $($(#[$field_meta:meta])+ $field:ident: $kind:ty),+ $(,)?
    }) => {
        $(#[$meta])+
        #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
        pub struct $type {
            $($(#[$field_meta])+ pub $field: $kind,)+
        }
    };
    (@lines $(
        $(#[doc = $doc:literal])+ $(#[serde $serde:tt])? $field:ident: $kind:tt $(<$element:tt>)?
    ),+ $(,)?) => {
        concat!($($("#", $doc, "\n",)+ ros_type!($kind $($element)?), " ", field_name!($field), "\n"),+)
    };
    (
        $(#[doc = $about:literal])+ $type:ident = $name:literal { $($body:tt)+ }
        $(constants [$($constant:literal),+ $(,)?])?
        $(with [$($nested:ident),+])?
    ) => {
        message!(@struct $(#[doc = $about])+ $type { $($body)+ });

        impl feeler_record::wire::Message for $type {
            const SCHEMA_NAME: &'static str = concat!("feeler_msgs/msg/", $name);
            const SCHEMA: &'static str = concat!(
                $("#", $about, "\n",)+
                "\n",
                $($($constant, "\n",)+)?
                message!(@lines $($body)+),
                $($($nested!(),)+)?
            );
        }
    };
}

/// Defines a type that is nested in messages, and a macro for its text.
macro_rules! nested_message {
    ($(#[doc = $about:literal])+ $(#[derive($copy:ident)])? $type:ident = $name:literal { $($body:tt)+ } as $text:ident) => {
        message!(@struct $(#[doc = $about])+ $(#[derive($copy)])? $type { $($body)+ });

        macro_rules! $text {
            () => {
                concat!(
                    "================================================================================\n",
                    "MSG: feeler_msgs/", $name, "\n",
                    message!(@lines $($body)+)
                )
            };
        }
    };
}

/// Returns the text of `geometry_msgs/Vector3`.
macro_rules! vector3_text {
    () => {
        concat!(feeler_record::wire::vector3_schema!(), "\n")
    };
}

/// Returns the text of `geometry_msgs/Quaternion`.
macro_rules! quaternion_text {
    () => {
        concat!(feeler_record::wire::quaternion_schema!(), "\n")
    };
}
