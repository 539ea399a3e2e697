//! `visualization_msgs/MarkerArray`.

use super::compressed_image::CompressedImage;
use super::header::{Header, header_schema, nested, quaternion_schema, xyz_schema};
use crate::wire::{Message, Quaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum MarkerType {
    /// A box of size `scale`.
    Cube = 1,
    /// An ellipsoid with diameters `scale`.
    Sphere = 2,
    /// A cylinder along z with diameters and length `scale`.
    Cylinder = 3,
    /// A line between each pair of points, with width `scale.x`.
    LineList = 5,
    /// A sphere with diameter `scale.x` at each point.
    SphereList = 7,
    /// A triangle for each three points.
    TriangleList = 11,
}

/// A colour with components from 0 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ColorRGBA {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
    /// Opacity.
    pub a: f32,
}

/// Pose of a marker in its frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkerPose {
    /// Origin (m).
    pub position: Vector3,
    /// Rotation.
    pub orientation: Quaternion,
}

/// A duration.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Duration {
    /// Whole seconds.
    pub sec: i32,
    /// Additional nanoseconds.
    pub nanosec: u32,
}

/// Coordinates in a texture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct UVCoordinate {
    /// Horizontal coordinate.
    pub u: f32,
    /// Vertical coordinate.
    pub v: f32,
}

/// A mesh file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MeshFile {
    /// File name.
    pub filename: String,
    /// File contents.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

/// A drawn object.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// Time and coordinate frame.
    pub header: Header,
    /// Namespace, which identifies the marker together with `id`.
    pub ns: String,
    /// Number of the marker in its namespace.
    pub id: i32,
    /// Shape, a [`MarkerType`].
    #[serde(rename = "type")]
    pub kind: i32,
    /// Action: 0 adds the marker.
    pub action: i32,
    /// Pose in the frame of `header`.
    pub pose: MarkerPose,
    /// Size (m).
    pub scale: Vector3,
    /// Colour.
    pub color: ColorRGBA,
    /// Duration for which the marker is shown; 0 means forever.
    pub lifetime: Duration,
    /// `true` if the marker moves with its frame.
    pub frame_locked: bool,
    /// Points of a list (m).
    pub points: Vec<Vector3>,
    /// Colours of a list's points.
    pub colors: Vec<ColorRGBA>,
    /// Not used, like all following fields.
    pub texture_resource: String,
    /// Texture image.
    pub texture: CompressedImage,
    /// Texture coordinates.
    pub uv_coordinates: Vec<UVCoordinate>,
    /// Text.
    pub text: String,
    /// Path of a mesh.
    pub mesh_resource: String,
    /// Mesh file.
    pub mesh_file: MeshFile,
    /// `true` if the mesh contains its colours.
    pub mesh_use_embedded_materials: bool,
}

impl Marker {
    /// Creates a marker that moves with `frame` and is shown until it is replaced.
    pub fn new(frame: impl Into<String>, ns: impl Into<String>, kind: MarkerType) -> Self {
        Self {
            header: Header::of(frame),
            ns: ns.into(),
            kind: kind as i32,
            frame_locked: true,
            ..Self::default()
        }
    }
}

/// A list of markers.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkerArray {
    /// The markers.
    pub markers: Vec<Marker>,
}

impl Message for MarkerArray {
    const SCHEMA_NAME: &'static str = "visualization_msgs/msg/MarkerArray";
    const SCHEMA: &'static str = concat!(
        "Marker[] markers\n",
        nested!(
            "visualization_msgs/Marker",
            "int32 ARROW=0",
            "int32 CUBE=1",
            "int32 SPHERE=2",
            "int32 CYLINDER=3",
            "int32 LINE_STRIP=4",
            "int32 LINE_LIST=5",
            "int32 CUBE_LIST=6",
            "int32 SPHERE_LIST=7",
            "int32 POINTS=8",
            "int32 TEXT_VIEW_FACING=9",
            "int32 MESH_RESOURCE=10",
            "int32 TRIANGLE_LIST=11",
            "int32 ARROW_STRIP=12",
            "int32 ADD=0",
            "int32 MODIFY=0",
            "int32 DELETE=2",
            "int32 DELETEALL=3",
            "std_msgs/Header header",
            "string ns",
            "int32 id",
            "int32 type",
            "int32 action",
            "geometry_msgs/Pose pose",
            "geometry_msgs/Vector3 scale",
            "std_msgs/ColorRGBA color",
            "builtin_interfaces/Duration lifetime",
            "bool frame_locked",
            "geometry_msgs/Point[] points",
            "std_msgs/ColorRGBA[] colors",
            "string texture_resource",
            "sensor_msgs/CompressedImage texture",
            "UVCoordinate[] uv_coordinates",
            "string text",
            "string mesh_resource",
            "MeshFile mesh_file",
            "bool mesh_use_embedded_materials",
        ),
        header_schema!(),
        nested!("builtin_interfaces/Duration", "int32 sec", "uint32 nanosec"),
        nested!(
            "geometry_msgs/Pose",
            "Point position",
            "Quaternion orientation"
        ),
        xyz_schema!("geometry_msgs/Point"),
        quaternion_schema!(),
        xyz_schema!("geometry_msgs/Vector3"),
        nested!(
            "std_msgs/ColorRGBA",
            "float32 r",
            "float32 g",
            "float32 b",
            "float32 a",
        ),
        nested!(
            "sensor_msgs/CompressedImage",
            "std_msgs/Header header",
            "string format",
            "uint8[] data",
        ),
        nested!("visualization_msgs/UVCoordinate", "float32 u", "float32 v"),
        nested!(
            "visualization_msgs/MeshFile",
            "string filename",
            "uint8[] data"
        ),
    );
}
