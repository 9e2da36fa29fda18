//! The scene runner's ways without a window, as from its command line.

use std::path::{Path, PathBuf};

use clap::Parser;
use drape_examples::scripted::arguments::SceneArguments;
use drape_examples::scripted::{replay as scene_replay, suite as scene_suite};

/// A ball that falls for half a second, from as high as `--set height=` says.
const SCENE: &str = r#"(
    version: 1,
    settings: (duration: 0.5),
    parameters: { "height": (default: (0, 10, 0), sets: ["ball.at"]) },
    bodies: { "ball": Balls(at: (0, 10, 0)) },
    expectations: [(probe: Position(of: "ball", axis: Y), expect: Near(value: 8.774, tolerance: 0.001))],
)"#;

/// A folder that is gone when the test is over.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("scene_demo_{name}_{}", std::process::id()));
        // A run that was killed may have left one.
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a folder for temporary files");
        Self(path)
    }

    fn with(self, file: &str, text: &str) -> Self {
        std::fs::write(self.0.join(file), text).expect("room for a small file");
        self
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn arguments(words: &[&str]) -> SceneArguments {
    SceneArguments::try_parse_from([&["scene"], words].concat()).expect("a command line")
}

fn passes(words: &[&str]) -> bool {
    scene_suite::run(&arguments(words)).expect("files that can be written")
}

#[test]
fn the_verdict_is_that_of_the_expectations() {
    let folder = Folder::new("verdict").with("a.scene.ron", SCENE);
    let scene = folder.path("a.scene.ron");
    assert!(passes(&[&scene, "--headless"]));
    assert!(passes(&[&scene, "--report", "json"]));
    assert!(!passes(&[&scene, "--report", "junit", "--set", "height=[0,11,0]"]), "it hangs too high");
    assert!(!passes(&[&scene, "--set", "no.such.thing=3"]));
    assert!(!passes(&[&folder.path("missing.scene.ron")]));
}

#[test]
fn a_folder_is_a_suite_and_one_that_fails_fails_it() {
    let folder = Folder::new("suite").with("a.scene.ron", SCENE).with("b.scene.ron", SCENE);
    let records = folder.path("records");
    assert!(passes(&[&folder.path(""), "--record", &records]));
    for name in ["a.drape", "b.drape"] {
        assert!(Path::new(&records).join(name).is_file(), "{name}");
    }
    let folder = folder.with("c.scene.ron", &SCENE.replace("8.774", "9"));
    assert!(!passes(&[&folder.path("")]));
    let empty = Folder::new("empty");
    let error = scene_suite::run(&arguments(&[&empty.path("")])).expect_err("nothing to run");
    assert!(error.to_string().contains(".scene.ron"), "{error}");
}

#[test]
fn recordings_are_replayed_and_two_runs_compared() {
    let folder = Folder::new("replay").with("a.scene.ron", SCENE);
    let scene = folder.path("a.scene.ron");
    let [first, second, other] = ["first.drape", "second.drape", "other.drape"].map(|name| folder.path(name));
    assert!(passes(&[&scene, "--record", &first]));
    assert!(passes(&[&scene, "--record", &second]));
    assert!(!passes(&[&scene, "--record", &other, "--set", "height=[0,10.5,0]"]));
    let replay = |other: Option<&String>| {
        scene_replay::run(Path::new(&first), other.map(|path| Path::new(path.as_str())))
    };
    assert!(replay(None).expect("a recording"));
    assert!(replay(Some(&second)).expect("recordings"), "two equal runs part");
    assert!(!replay(Some(&other)).expect("recordings"), "another height and the same places");
    let error = replay(Some(&scene)).expect_err("no recording");
    assert!(error.to_string().contains("a.scene.ron"), "{error}");
}

#[test]
fn plots_are_drawn() {
    let folder = Folder::new("plot").with("a.scene.ron", SCENE);
    assert!(passes(&[&folder.path("a.scene.ron"), "--plot", "--out", &folder.path("plots")]));
    let plot = std::fs::read_to_string(folder.0.join("plots/a.svg")).expect("a plot");
    assert!(plot.contains("polyline"), "no curve in it");
}

#[test]
fn checkpoints_are_written_and_gone_on_from() {
    let scene = SCENE.replace("bodies:", "timeline: [(at: 0.25, do: Checkpoint(\"half\"))],\n    bodies:");
    let folder = Folder::new("checkpoint").with("a.scene.ron", &scene);
    let out = folder.path("out");
    assert!(passes(&[&folder.path("a.scene.ron"), "--out", &out]));
    let checkpoint = folder.path("out/a.half.checkpoint");
    assert!(passes(&[&checkpoint, "--out", &out]), "it goes on to somewhere else");
    std::fs::write(&checkpoint, "nothing of the kind").expect("written");
    assert!(scene_suite::run(&arguments(&[&checkpoint])).is_err());
}

#[test]
fn pictures_are_drawn_or_it_is_told_how() {
    let folder = Folder::new("pictures").with("a.scene.ron", &SCENE.replace("8.774", "9"));
    let frames = folder.path("frames");
    let drawn = scene_suite::run(&arguments(&[&folder.path("a.scene.ron"), "--frames", &frames]));
    match drawn {
        Ok(passed) => {
            assert!(!passed, "it hangs too high");
            for name in ["a.whole.1_start.png", "a.whole.3_end.png", "a.failed_1.png"] {
                assert!(Path::new(&frames).join(name).is_file(), "{name}");
            }
        }
        // Without the feature, or a graphics adapter.
        Err(error) => {
            let told = error.to_string();
            assert!(told.contains("feature `render`") || told.contains("adapter"), "{told}");
        }
    }
}
