//! Invalid policy files are rejected with the expected and the actual content.

use super::policy::saying;
use super::policy_file::PolicyFile;
use feeler::control::law::policy::PolicyModel;
use safetensors::tensor::{Dtype, TensorView, serialize};

fn good() -> PolicyFile {
    PolicyFile::drawn(2, &[5, 4], 3)
}

/// Asserts that `bytes` are rejected with a message that contains all of `words`.
fn refused(bytes: &[u8], words: &[&str]) {
    let Err(error) = PolicyModel::from_bytes(bytes) else {
        panic!("expected an error with {words:?}, but the policy was accepted");
    };
    let error = error.to_string();
    for word in words {
        assert!(error.contains(word), "no {word:?} in {error:?}");
    }
}

#[test]
fn invalid_metadata_are_named() {
    assert!(PolicyModel::from_bytes(&saying(good(), "description", "any ✓").bytes()).is_ok());
    for (key, value, words) in [
        (
            "format",
            "feeler-policy-2",
            &[
                "metadata format: expected \"feeler-policy-1\"",
                "got \"feeler-policy-2\"",
            ][..],
        ),
        (
            "activation",
            "gelu",
            &["activation: expected \"tanh\" or \"relu\", got \"gelu\""],
        ),
        (
            "elements",
            "0",
            &["elements: expected", "from 1 to 512, got \"0\""],
        ),
        (
            "elements",
            "513",
            &["elements: expected", "from 1 to 512, got \"513\""],
        ),
        (
            "elements",
            "-1",
            &["metadata elements: expected", "got \"-1\""],
        ),
        (
            "elements",
            "two",
            &["metadata elements: expected", "got \"two\""],
        ),
        (
            "joints",
            "0",
            &["metadata joints: expected", "from 1 to 7, got \"0\""],
        ),
        ("joints", "8", &["from 1 to 7, got \"8\""]),
        ("joints", "4", &["input.mean: expected F32 of shape [29]"]),
        (
            "elements",
            "3",
            &[
                "input.mean: expected F32 of shape [30]",
                "got F32 of shape [27]",
            ],
        ),
        (
            "residual_speed",
            "nan",
            &[
                "metadata residual_speed: expected",
                "got \"nan\"",
                "0 to 1 m/s",
            ],
        ),
        (
            "residual_speed",
            "-0.1",
            &["metadata residual_speed: expected", "got \"-0.1\""],
        ),
        (
            "residual_speed",
            "1.1",
            &["metadata residual_speed: expected", "got \"1.1\""],
        ),
        (
            "framework",
            "jax",
            &[
                "metadata framework: expected",
                "residual_speed, description, got an unknown entry",
            ],
        ),
    ] {
        refused(&saying(good(), key, value).bytes(), words);
    }
    for key in ["format", "activation", "elements", "residual_speed"] {
        let mut file = good();
        file.metadata.remove(key);
        refused(&file.bytes(), &[key, "missing"]);
    }
}

#[test]
fn missing_misshapen_and_unknown_tensors_are_rejected() {
    let names: Vec<_> = good().tensors.into_keys().collect();
    for name in &names {
        let mut file = good();
        file.tensors.remove(name);
        refused(&file.bytes(), &["tensor", "expected"]);
        for (number, shown) in [
            (f32::NAN, "NaN"),
            (f32::INFINITY, "inf"),
            (-1.1e6, "-1100000"),
            (2e6, "2000000"),
        ] {
            let mut file = good();
            let (_, numbers) = file.tensors.get_mut(name).expect("a tensor");
            numbers[1] = number;
            refused(&file.bytes(), &[name, shown, "at index 1", "to 1e6"]);
        }
    }
    type Change = (&'static str, &'static [usize], &'static [&'static str]);
    let changes: [Change; 8] = [
        (
            "input.scale",
            &[26],
            &[
                "input.scale: expected F32 of shape [27]",
                "got F32 of shape [26]",
            ],
        ),
        (
            "layer0.weight",
            &[27, 5],
            &[
                "layer0.weight: expected F32 of shape [27, 27]",
                "got F32 of shape [27, 5]",
            ],
        ),
        (
            "layer0.weight",
            &[1025, 27],
            &["layer0.weight: expected 1 to 1024 outputs, got shape [1025, 27]"],
        ),
        (
            "layer0.weight",
            &[0, 27],
            &["layer0.weight: expected 1 to 1024 outputs, got shape [0, 27]"],
        ),
        (
            "layer0.weight",
            &[],
            &["layer0.weight: expected 1 to 1024 outputs, got shape []"],
        ),
        (
            "layer1.bias",
            &[4, 1],
            &["layer1.bias: expected F32 of shape [4], got F32 of shape [4, 1]"],
        ),
        (
            "layer2.weight",
            &[4, 4],
            &[
                "layer2.weight: expected F32 of shape [3, 4]",
                "got F32 of shape [4, 4]",
            ],
        ),
        (
            "layer4.weight",
            &[3, 3],
            &[
                "layer4.weight: expected only",
                "layer2.bias; up to 8 layers, got an unknown tensor",
            ],
        ),
    ];
    for (name, shape, words) in changes {
        let mut file = good();
        file.put(name, shape, vec![0.5; shape.iter().product()]);
        refused(&file.bytes(), words);
    }
    let mut file = good();
    file.put("input.scale", &[27], vec![0.0; 27]);
    refused(
        &file.bytes(),
        &[
            "input.scale: expected",
            "from 1e-6 to 1e6, got 0 at index 0",
        ],
    );
    refused(
        &PolicyFile::drawn(2, &[4; 8], 3).bytes(),
        &["layer7.weight: expected", "got F32 of shape [4, 4]"],
    );
}

#[test]
fn tensors_must_be_single_precision() {
    let numbers = [0_u8; 27 * 8];
    let view = TensorView::new(Dtype::F64, vec![27], &numbers).expect("a tensor");
    let metadata = good().metadata.into_iter().collect();
    let bytes = serialize([("input.mean", view)], Some(metadata)).expect("its bytes");
    refused(
        &bytes,
        &[
            "input.mean: expected F32 of shape [27]",
            "got F64 of shape [27]",
        ],
    );
}

#[test]
fn damaged_files_are_rejected() {
    let whole = good().bytes();
    for length in 0..whole.len() {
        refused(&whole[..length], &["safetensors"]);
    }
    refused(
        &[&whole[..], &[0]].concat(),
        &["not fully covered", "safetensors"],
    );
    refused(b"[control]\nperiod = 0.01\n", &["safetensors"]);
    refused(&[0xff; 64], &["header", "safetensors"]);
    refused(
        &vec![0; (40 << 20) + 1],
        &["at most 41943040 bytes", "got 41943041"],
    );
    let mut broken = whole;
    for byte in 0..400 {
        broken[byte] ^= 0x55;
        // If the file is invalid now, the message states what was expected.
        if let Err(error) = PolicyModel::from_bytes(&broken) {
            assert!(error.to_string().contains("expected"), "{error}");
        }
        broken[byte] ^= 0x55;
    }
}
