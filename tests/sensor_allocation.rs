//! Reading the sensor does not allocate.

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use feeler::sensor::{
    fingertip::{Fingertip, FingertipConfig},
    frame::Picture,
    moments::ElementMoments,
};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

#[test]
fn moments_are_taken_without_allocating() {
    let fingertip = Fingertip::new(&FingertipConfig::default()).unwrap();
    let picture = Picture::black(640, 480);
    let mut moments = vec![ElementMoments::default(); 41];
    let measured = assert_no_alloc(|| fingertip.kernel.measure(&picture, &mut moments));
    assert_eq!(measured, Ok(()));
}
