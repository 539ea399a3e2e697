//! Markers followed by identity, in pictures that are drawn where every marker is known.

mod scene;
mod single;
mod video;
