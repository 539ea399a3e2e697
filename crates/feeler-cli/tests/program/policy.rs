//! A learned policy as the control law of runs, replays, sweeps and comparisons.

use crate::policy_file::PolicyFile;
use crate::program::{document, experiment, folder, rows, run};
use std::fs;
use std::path::Path;

/// Writes a policy file.
fn write(path: &Path, file: &PolicyFile) {
    fs::write(path, file.bytes()).expect("a policy");
}

/// A random policy for the reference fingertip.
fn drawn(seed: u64) -> PolicyFile {
    PolicyFile::drawn(41, &[16, 16], seed)
}

/// Writes `my.toml` to `folder`: the reference experiment with the policy file `name`, which is in the same folder.
fn with_policy(folder: &Path, name: &str) {
    let law = format!("[control]\nlaw.policy = {{ file = {name:?} }}\n");
    experiment(folder, "[control]\n", &law);
}

/// A policy of zeros adds nothing to the plan, and neither does the paper's law with a recompression speed of zero.
#[test]
fn policy_of_zeros_equals_the_papers_law_without_its_reflex() {
    let folder = folder("policy-zero");
    write(
        &folder.join("nil.v1.safetensors"),
        &PolicyFile::zero(41, &[8]),
    );
    write(&folder.join("drawn.safetensors"), &drawn(1));
    let arguments = [
        "compare",
        "cap-closing",
        "--laws=tri-axial",
        "--policy=nil.v1.safetensors",
        "--policy=drawn.safetensors",
        "--trials=3",
        "--set=control.recompression_speed=0.0",
        "-o=c",
    ];
    let said = run(&folder, &arguments).done();
    for words in ["tri-axial (", "nil.v1\n", "drawn compared with tri-axial: "] {
        assert!(said.contains(words), "no {words:?} in {said}");
    }
    let [paper, zero, other] = ["tri-axial", "nil.v1", "drawn"]
        .map(|law| rows(&folder.join("c").join(law).join("trials.csv")));
    assert_eq!((paper.len(), zero.len(), other.len()), (3, 3, 3));
    for (row, papers) in zero.iter().zip(&paper) {
        // The paper's claims, and the success that depends on them, apply only to its law.
        let about_all = |name: &&String| !name.starts_with("claim") && *name != "success";
        for name in row.keys().filter(about_all) {
            assert_eq!(row[name], papers[name], "{name}");
        }
    }
    assert!(
        other
            .iter()
            .zip(&paper)
            .all(|(row, papers)| row["cap_torque"] != papers["cap_torque"])
    );
    let page = document(&folder.join("c/compare.html"));
    assert!(page.contains("nil.v1") && page.contains("success (%) against friction"));
    assert!(!page.contains("NaN"));
}

#[test]
fn run_replays_with_the_recorded_policy() {
    let folder = folder("policy-replay");
    let there = folder.join("there");
    fs::create_dir(&there).unwrap();
    write(&there.join("my.safetensors"), &drawn(2));
    with_policy(&there, "my.safetensors");
    let said = run(&folder, &["check", "there/my.toml"]).done();
    assert!(said.contains("good"), "{said}");
    let arguments = ["run", "there/my.toml", "--sensing=direct", "--out=run"];
    let ended = run(&folder, &arguments);
    assert!(matches!(ended.status, Some(0 | 1)), "{ended:?}");
    fs::remove_file(there.join("my.safetensors")).unwrap();
    let replay = |name: &str, more: &[&str]| {
        run(
            &folder,
            &[&["replay", name, "--from=forces"], more].concat(),
        )
    };
    assert!(
        replay("run", &["--out=copy"])
            .done()
            .contains("bit for bit")
    );
    assert!(replay("copy", &[]).done().contains("bit for bit"));

    // Another policy, whose path is relative to the working directory.
    write(&folder.join("other.safetensors"), &drawn(3));
    let other = ["--set=control.law={ policy = { file = \"other.safetensors\" } }"];
    let said = replay("run", &other);
    assert!(
        said.stdout.contains("first difference of commands"),
        "{said:?}"
    );
    replay("run", &["--set=control.law.policy.file=gone.safetensors"]).refused(&[
        "control.law.policy.file = \"gone.safetensors\"",
        "expected the file of a policy",
    ]);
    run(&folder, &arguments).refused(&[
        "control.law.policy.file = \"my.safetensors\"",
        "there/my.safetensors",
    ]);
}

#[test]
fn sweep_resumes_only_with_its_original_policy() {
    let folder = folder("policy-sweep");
    let file = folder.join("my.safetensors");
    write(&file, &drawn(4));
    let own = fs::read(&file).unwrap();
    with_policy(&folder, "my.safetensors");
    let sweep = ["sweep", "my.toml", "--sensing=direct", "--trials=2", "-o=s"];
    run(&folder, &sweep).done();
    let plan = fs::read_to_string(folder.join("s/sweep.toml")).unwrap();
    assert!(plan.contains("policy = \""), "{plan}");
    let resumed = [&sweep[..], &["--resume"]].concat();
    run(&folder, &resumed).done();

    write(&file, &drawn(5));
    run(&folder, &resumed).refused(&["its policy has the SHA-256", "unchanged"]);
    for arguments in [
        &["sweep", "--resume", "-o=s"][..],
        &["run", "--trial", "s", "1", "--out=again"],
        &["sweep", "merge", "s", "-o=joined"],
    ] {
        let words = [
            "control.law.policy.file = \"my.safetensors\"",
            "SHA-256",
            "with which the sweep was started",
        ];
        run(&folder, arguments).refused(&words);
    }
    fs::write(&file, own).unwrap();
    let again = ["run", "--trial", "s", "1", "--out=again"];
    assert!(matches!(run(&folder, &again).status, Some(0 | 1)));
    let vary = "--vary=control.law.policy.file=choice(\"my.safetensors\",\"other.safetensors\")";
    run(&folder, &["sweep", "my.toml", vary, "-o=v"]).refused(&[
        "--vary",
        "a sweep has one policy",
        "feeler compare",
    ]);
    assert!(!folder.join("v").exists());
}

#[test]
fn invalid_policies_are_refused_before_the_run() {
    let folder = folder("policy-refused");
    write(
        &folder.join("small.safetensors"),
        &PolicyFile::drawn(40, &[4], 1),
    );
    write(&folder.join("best.safetensors"), &drawn(1));
    write(&folder.join("odd name.safetensors"), &drawn(1));
    let mut nan = drawn(1);
    nan.put("layer0.bias", &[16], vec![f32::NAN; 16]);
    write(&folder.join("nan.safetensors"), &nan);
    fs::write(folder.join("text.safetensors"), "no policy").unwrap();
    for (name, words) in [
        (
            "gone.safetensors",
            &["gone.safetensors", "expected the file of a policy"][..],
        ),
        (
            "text.safetensors",
            &[
                "text.safetensors",
                "expected a complete file in safetensors format",
            ],
        ),
        (
            "nan.safetensors",
            &[
                "tensor layer0.bias: expected numbers from",
                "got NaN at index 0",
            ],
        ),
        (
            "small.safetensors",
            &["for fingertips of 41 elements", "for 40"],
        ),
        (".", &["control.law.policy.file = \".\"", "directory"]),
    ] {
        let set = format!("--set=control.law.policy.file={name}");
        run(&folder, &["check", "cap-closing", &set]).refused(words);
        run(&folder, &["run", "cap-closing", &set, "--out=r"]).refused(words);
        run(&folder, &["sweep", "cap-closing", &set, "-o=s"]).refused(words);
    }
    for (file, words) in [
        (
            "gone.safetensors",
            &["--policy gone.safetensors", "No such file"][..],
        ),
        ("small.safetensors", &["small.safetensors", "for 40"]),
        (
            "best.safetensors",
            &[
                "--policy best.safetensors",
                "the name best is already taken",
            ],
        ),
        (
            "odd name.safetensors",
            &["--policy odd name.safetensors", "letters, digits"],
        ),
    ] {
        run(
            &folder,
            &["compare", "cap-closing", "--policy", file, "-o=c"],
        )
        .refused(words);
    }
    for left in ["r", "s", "c"] {
        assert!(!folder.join(left).exists(), "{left}");
    }
    let task = [
        "check",
        "lift",
        "--set=control.law.policy.file=best.safetensors",
    ];
    run(&folder, &task).refused(&[
        "control.law = \"policy\"",
        "task.carry controls its contact forces itself",
    ]);
}
