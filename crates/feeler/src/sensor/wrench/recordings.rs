//! Groups images into recordings by folder and file name.

use std::collections::HashMap;

/// Recording and position in time of an image, derived from its file name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlaceInTime {
    /// Name of the recording that contains the image.
    pub recording: String,
    /// Number at the end of the image name, which gives the order within the recording.
    pub number: Option<u64>,
}

/// Splits the name of an image into recording and number: `images/press_3_0042.png` is number 42 of `images/press_3`,
/// and `a/0042.png` is number 42 of `a`.
pub fn place_in_time(picture: &str) -> PlaceInTime {
    let (folder, file) = match picture.rfind(['/', '\\']) {
        Some(end) => (&picture[..end], &picture[end + 1..]),
        None => ("", picture),
    };
    let stem = match file.rfind('.') {
        Some(end) if end > 0 => &file[..end],
        _ => file,
    };
    let name = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = stem[name.len()..].parse().ok();
    let name = name.trim_end_matches(['_', '-', '.', ' ', '(', '#']);
    let recording = match (folder, name) {
        ("", name) => name.to_owned(),
        (folder, "") => folder.to_owned(),
        (folder, name) => format!("{folder}/{name}"),
    };
    PlaceInTime { recording, number }
}

/// Groups `pictures` into recordings. Returns the names of the recordings, and for each image the index of its
/// recording and its position in time.
///
/// If names do not distinguish recordings (nearly every image would be a recording), all images form one recording in
/// the given order.
pub fn recordings<'a>(pictures: impl Iterator<Item = &'a str>) -> (Vec<String>, Vec<(usize, u64)>) {
    let places: Vec<_> = pictures.map(place_in_time).collect();
    let (names, of) = number_names(places.iter().map(|place| place.recording.as_str()));
    if names.len() > 1 && 2 * names.len() > places.len() {
        let order = (0..places.len()).map(|place| (0, place as u64));
        return (vec!["all".into()], order.collect());
    }
    // In a recording with names without a number, keep the given order.
    let mut numbered = vec![true; names.len()];
    for (place, &recording) in places.iter().zip(&of) {
        numbered[recording] &= place.number.is_some();
    }
    let order = places.iter().zip(of).enumerate();
    let order = order.map(|(given, (place, recording))| match place.number {
        Some(number) if numbered[recording] => (recording, number),
        _ => (recording, given as u64),
    });
    (names, order.collect())
}

/// Returns the distinct names in order of first occurrence, and for each name its index among them.
pub fn number_names<'a>(names: impl Iterator<Item = &'a str>) -> (Vec<String>, Vec<usize>) {
    let mut numbers: HashMap<&str, usize> = HashMap::new();
    let mut different = Vec::new();
    let of = names.map(|name| {
        *numbers.entry(name).or_insert_with(|| {
            different.push(name.to_owned());
            different.len() - 1
        })
    });
    let of = of.collect();
    (different, of)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn groups_and_orders_images_by_name() {
        for (picture, recording, number) in [
            ("images/press_3_0042.png", "images/press_3", Some(42)),
            ("a/0042.png", "a", Some(42)),
            ("frame12.jpg", "frame", Some(12)),
            ("left.png", "left", None),
            ("a\\b\\run-7.png", "a\\b/run", Some(7)),
            (".png", ".png", None),
            ("", "", None),
            ("99999999999999999999999.png", "", None),
        ] {
            let found = place_in_time(picture);
            assert_eq!(
                (&*found.recording, found.number),
                (recording, number),
                "{picture}"
            );
        }
        let (names, order) = recordings(["b_10.png", "b_9.png", "a_1.png", "a_2.png"].into_iter());
        assert_eq!(names, ["b", "a"]);
        assert_eq!(order, [(0, 10), (0, 9), (1, 1), (1, 2)]);
        let (names, order) = recordings(["1_left.png", "2_left.png", "3_left.png"].into_iter());
        assert_eq!(names, ["all"]);
        assert_eq!(order, [(0, 0), (0, 1), (0, 2)]);
    }

    proptest! {
        #[test]
        fn every_picture_is_of_a_recording(pictures in proptest::collection::vec(".{0,12}", 0..20)) {
            let (names, order) = recordings(pictures.iter().map(String::as_str));
            prop_assert_eq!(order.len(), pictures.len());
            prop_assert!(order.iter().all(|&(recording, _)| recording < names.len()));
        }
    }
}
