//! `visualization_msgs/MarkerArray`.

use super::compressed_image::CompressedImage;
use super::header::{Header, header_schema, nested, quaternion_schema, xyz_schema};
use crate::wire::{Message, Quaternion, Vector3};
use glam::DQuat;
use serde::{Deserialize, Serialize};

/// What a marker is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum MarkerType {
    /// A box of the sizes `scale`.
    Cube = 1,
    /// An ellipsoid of the diameters `scale`.
    Sphere = 2,
    /// A cylinder along z, of the diameters and the length `scale`.
    Cylinder = 3,
    /// Lines between each two points, as wide as `scale.x`.
    LineList = 5,
    /// A sphere of the diameter `scale.x` at each point.
    SphereList = 7,
    /// A triangle for each three points.
    TriangleList = 11,
}

/// A colour; all parts from 0 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ColorRGBA {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
    /// How much hides what is behind.
    pub a: f32,
}

/// Where a marker is in its frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MarkerPose {
    /// Its origin, m.
    pub position: Vector3,
    /// Its rotation.
    pub orientation: Quaternion,
}

/// A span of time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Duration {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds after them.
    pub nanosec: u32,
}

/// A place in a texture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct UVCoordinate {
    /// Along the picture.
    pub u: f32,
    /// Down the picture.
    pub v: f32,
}

/// A file with a mesh.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MeshFile {
    /// Its name.
    pub filename: String,
    /// Its bytes.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

/// Something to be drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// When, and in which frame.
    pub header: Header,
    /// What it belongs to; with `id` it says which marker it is.
    pub ns: String,
    /// Its number.
    pub id: i32,
    /// What it is: a [`MarkerType`].
    #[serde(rename = "type")]
    pub kind: i32,
    /// 0: it is there from now on.
    pub action: i32,
    /// Where it is.
    pub pose: MarkerPose,
    /// Its size, m.
    pub scale: Vector3,
    /// Its colour.
    pub color: ColorRGBA,
    /// How long it is there; for ever if 0.
    pub lifetime: Duration,
    /// Whether it moves with its frame.
    pub frame_locked: bool,
    /// Of lists: the points, m.
    pub points: Vec<Vector3>,
    /// Of lists: the points' colours.
    pub colors: Vec<ColorRGBA>,
    /// Without use here, as all that follows.
    pub texture_resource: String,
    /// A picture on it.
    pub texture: CompressedImage,
    /// Where that is.
    pub uv_coordinates: Vec<UVCoordinate>,
    /// A text.
    pub text: String,
    /// A mesh.
    pub mesh_resource: String,
    /// The mesh's file.
    pub mesh_file: MeshFile,
    /// Whether it has its own colours.
    pub mesh_use_embedded_materials: bool,
}

impl Marker {
    /// A marker that moves with `frame`, until it is told again.
    pub fn new(frame: impl Into<String>, ns: impl Into<String>, kind: MarkerType) -> Self {
        Self {
            header: Header::of(frame),
            ns: ns.into(),
            id: 0,
            kind: kind as i32,
            action: 0,
            pose: MarkerPose {
                position: Vector3::default(),
                orientation: DQuat::IDENTITY.into(),
            },
            scale: Vector3::default(),
            color: ColorRGBA::default(),
            lifetime: Duration::default(),
            frame_locked: true,
            points: Vec::new(),
            colors: Vec::new(),
            texture_resource: String::new(),
            texture: CompressedImage::default(),
            uv_coordinates: Vec::new(),
            text: String::new(),
            mesh_resource: String::new(),
            mesh_file: MeshFile::default(),
            mesh_use_embedded_materials: false,
        }
    }
}

/// Things to be drawn.
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
