//! The built-in experiments.

/// A built-in experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltIn {
    /// Name of the experiment.
    pub name: &'static str,
    /// Text of the experiment file.
    pub toml: &'static str,
}

/// Builds the array of experiments with the given names from their files.
macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        [$(BuiltIn {
            name: $name,
            toml: include_str!(concat!("../../experiments/", $name, ".toml")),
        }),*]
    };
}

/// All built-in experiments.
pub const BUILT_IN: [BuiltIn; 15] = built_in![
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
    "grip",
    "bench-rig",
];
