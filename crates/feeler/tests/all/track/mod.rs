//! Tracking of marker identities in synthetic images with known marker places.

mod scene;
mod single;
mod video;
