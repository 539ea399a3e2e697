//! The experiments that come with the program.

/// An experiment that comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltIn {
    /// The name to call it by.
    pub name: &'static str,
    /// Its file.
    pub toml: &'static str,
}

/// The experiments of these names, from their files.
macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        [$(BuiltIn {
            name: $name,
            toml: include_str!(concat!("../../experiments/", $name, ".toml")),
        }),*]
    };
}

/// The experiments that come with the program.
pub const BUILT_IN: [BuiltIn; 14] = built_in![
    "cap-closing",
    "any-hand",
    "cap-opening",
    "cap-until-closed",
    "cap-closing-pins",
    "cap-closing-fibres",
    "cap-closing-gel",
    "three-fingers",
    "contour",
    "friction-scan",
    "slide-box",
    "slide-box-two",
    "lift",
    "bench-rig",
];
