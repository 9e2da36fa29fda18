//! Bodies of meshes: from files, from shapes, by hand.

#[expect(dead_code, reason = "nothing here is about random numbers")]
mod random;

use std::path::{Path, PathBuf};

use bevy::asset::{AssetPlugin, LoadState};
use bevy::ecs::message::{MessageCursor, Messages};
use bevy::prelude::*;
use bevy_drape::body::Pressure;
use bevy_drape::prelude::*;
use bevy_drape_script::asset::{SceneAssetPlugin, SceneScriptLoader};
use bevy_drape_script::checkpoint::Checkpoint;
use bevy_drape_script::play::{CheckpointTaken, ScenePlay};
use bevy_drape_script::{SceneError, SceneRunner, SceneScript};
use proptest::prelude::*;

const CAPE: &[u8] = include_bytes!("../../../assets/models/cape.glb");

/// A folder with the cape and a scene in it; the scene's path.
fn scene_with_cape(folder: &str, text: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    std::fs::create_dir_all(folder.join("models")).expect("a folder");
    std::fs::write(folder.join("models/cape.glb"), CAPE).expect("written");
    let path = folder.join("cape.scene.ron");
    std::fs::write(&path, text).expect("written");
    path
}

/// A scene with this body.
fn of_body(body: &str) -> String {
    format!("(version: 1, settings: (duration: 1), bodies: {{ \"it\": {body} }})")
}

const CAPE_BODY: &str = r#"ClothMesh(mesh: File(path: "models/cape.glb", name: "Cape"))"#;

fn particles<'a>(runner: &'a SceneRunner, name: &str) -> &'a Particles {
    let world = runner.world();
    let bodies = world.resource::<ScenePlay>().bodies(world);
    let (_, entity) = bodies.into_iter().find(|(own, _)| own == name).expect("it is there");
    world.get(entity).expect("it has been built")
}

#[test]
fn a_cape_from_a_file_has_its_pins_where_they_are_painted() {
    let path = scene_with_cape("painted", &of_body(CAPE_BODY));
    let mut runner = SceneRunner::headless(SceneScript::load(&path).expect("a good scene"));
    runner.step();
    let cape = particles(&runner, "it");
    let height = |i: usize| cape.position(i).y;
    let pins: Vec<usize> = (0..cape.len()).filter(|&i| cape.is_pinned(i)).collect();
    assert!(!pins.is_empty() && pins.len() < cape.len() / 4, "{} of {}", pins.len(), cape.len());
    let lowest_pin = pins.iter().map(|&i| height(i)).fold(f32::INFINITY, f32::min);
    let free = (0..cape.len()).filter(|i| !pins.contains(i));
    assert!(free.map(height).all(|height| height < lowest_pin), "the collar is its top");
}

#[test]
fn what_is_painted_may_be_let_be_and_let_go() {
    let text = of_body(&CAPE_BODY.replace("))", "), painted_pins: None, pins: [0])"));
    let mut runner =
        SceneRunner::headless(SceneScript::load(scene_with_cape("free", &text)).expect("a scene"));
    runner.step();
    let cape = particles(&runner, "it");
    assert_eq!((0..cape.len()).filter(|&i| cape.is_pinned(i)).count(), 1);

    let text = of_body(CAPE_BODY).replace("bodies:", "timeline: [(at: 0.5, do: Unpin(of: \"it\"))], bodies:");
    let mut runner =
        SceneRunner::headless(SceneScript::load(scene_with_cape("let_go", &text)).expect("a scene"));
    while runner.step() {}
    let cape = particles(&runner, "it");
    assert!((0..cape.len()).all(|i| cape.inverse_mass(i) > 0.0));
    // All of it falls for half a second: 1.2 m.
    assert!((0..cape.len()).all(|i| cape.position(i).y < 0.6));
}

#[test]
fn errors_tell_file_line_and_what_there_is_instead() {
    let error = |name: &str, body: &str| -> SceneError {
        SceneScript::load(scene_with_cape(name, &of_body(body))).expect_err("a bad scene")
    };
    let said = |error: SceneError, parts: &[&str]| {
        let text = error.to_string();
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
        assert_eq!(
            (error.line, error.field.as_str().starts_with("bodies.it.mesh")),
            (Some(1), true),
            "{text}"
        );
    };
    said(error("missing", &CAPE_BODY.replace("cape.glb", "cap.glb")), &["models/cap.glb", "cannot be read"]);
    said(error("misspelt", &CAPE_BODY.replace("\"Cape\"", "\"Cap\"")), &["did you mean `Cape`?", "Figure"]);
    said(error("unnamed", &CAPE_BODY.replace(", name: \"Cape\"", "")), &["`name`", "Figure, Cape"]);
    said(error("not_glb", &CAPE_BODY.replace("models/cape.glb", "cape.scene.ron")), &["`.glb`"]);
    said(error("open", &CAPE_BODY.replace("ClothMesh", "SoftBody")), &["not closed"]);
    said(error("no_pin", &CAPE_BODY.replace("))", "), pins: [99999])")), &["99999"]);
    said(
        error(
            "no_corner",
            "ClothMesh(mesh: Triangles(vertices: [(0, 0, 0), (1, 0, 0)], triangles: [(0, 1, 2)]))",
        ),
        &["2"],
    );

    // A text without a file has no folder.
    said(SceneScript::parse(&of_body(CAPE_BODY)).expect_err("no folder"), &["a scene that is no file"]);
}

#[test]
fn particles_of_meshes_are_counted() {
    // A divided icosahedron has 10 * 4^n + 2 corners.
    for (divisions, corners) in [(0, 12), (1, 42), (2, 162), (3, 642)] {
        let body = format!("ClothMesh(mesh: Sphere(radius: 0.3, divisions: {divisions}))");
        let pin = |index: u32| {
            let pin =
                format!("timeline: [(at: 0, do: Pin(of: \"it\", particles: Particles([{index}])))], bodies:");
            SceneScript::parse(&of_body(&body).replace("bodies:", &pin))
        };
        pin(corners - 1).expect("the last");
        let error = pin(corners).expect_err("none beyond").to_string();
        assert!(error.contains(&format!("below {corners}")), "{error}");
    }
    // Two cells along each side are 27 corners.
    let solid = of_body("SoftBody(mesh: Cuboid(size: (0.4, 0.4, 0.4)), spacing: 0.2)");
    let mut runner = SceneRunner::headless(SceneScript::parse(&solid).expect("a scene"));
    runner.step();
    assert_eq!(particles(&runner, "it").len(), 27);
}

#[test]
fn only_what_is_closed_has_a_volume() {
    let volume = "expectations: [(probe: Volume(of: \"it\"), expect: Reported)], bodies:";
    let parse = |body: &str| SceneScript::parse(&of_body(body).replace("bodies:", volume));
    parse("ClothMesh()").expect("a sphere");
    parse("SoftBody()").expect("a solid");
    for open in [
        "Cloth()",
        "Rope()",
        "ClothMesh(mesh: Triangles(vertices: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], triangles: [(0, 1, 2)]))",
    ] {
        let error = parse(open).expect_err("open").to_string();
        assert!(error.contains("closed mesh"), "{error}");
    }
}

#[test]
fn another_mesh_makes_another_body_and_another_stiffness_does_not() {
    let events = r#"timeline: [
        (at: 0.3, do: Set("it.pressure", 1.2)),
        (at: 0.5, do: Set("it.bend_stiffness", 0.5)),
        (at: 0.7, do: Set("it.mesh", Sphere(radius: 0.2, divisions: 1))),
    ], bodies:"#;
    let text = of_body("ClothMesh(velocity: (1, 0, 0))").replace("bodies:", events);
    let mut runner = SceneRunner::headless(SceneScript::parse(&text).expect("a scene"));
    let entity = |runner: &SceneRunner| runner.world().resource::<ScenePlay>().entities("it")[0];
    runner.step();
    let first = entity(&runner);
    while runner.world().resource::<ScenePlay>().steps() < 40 {
        runner.step();
    }
    assert_eq!(entity(&runner), first);
    assert_eq!(runner.world().get::<Pressure>(first), Some(&Pressure(1.2)));
    assert_eq!(runner.world().get::<Fabric>(first).map(|fabric| fabric.bend_stiffness), Some(0.5));
    while runner.step() {}
    assert_ne!(entity(&runner), first);
    assert_eq!(particles(&runner, "it").len(), 42);
    assert!(runner.report().passed());
}

#[test]
fn a_file_that_was_not_read_is_told_when_the_scene_asks_for_it() {
    let event = r#"timeline: [(at: 0.2, do: Set("it.mesh", File(path: "models/other.glb")))], bodies:"#;
    let path = scene_with_cape("asked", &of_body(CAPE_BODY).replace("bodies:", event));
    let report = SceneRunner::headless(SceneScript::load(path).expect("a scene")).run();
    assert!(report.complaint().contains("`models/other.glb` has not been read"), "{}", report.complaint());
}

#[test]
fn bodies_of_meshes_go_on_from_a_checkpoint_with_the_same_bits() {
    let text = r#"(
        version: 1,
        settings: (duration: 1.5, wind: (velocity: (0, 0, 3))),
        bodies: {
            "cape": ClothMesh(mesh: File(path: "models/cape.glb", name: "Cape"), painted_limits: Green),
            "balloon": ClothMesh(at: (2, 1, 0), pressure: 1.1),
            "jelly": SoftBody(at: (4, 0.5, 0)),
        },
        obstacles: { "ground": (shape: Ground) },
        timeline: [(at: 0.7, do: Checkpoint("half")), (at: 0.9, do: Unpin(of: "cape"))],
        expectations: [(probe: Volume(of: ["balloon", "jelly"]), expect: Near(value: 1, tolerance: 0.2))],
    )"#;
    let path = scene_with_cape("resumed", text);
    let mut runner = SceneRunner::headless(SceneScript::load(&path).expect("a scene"));
    // The checkpoint needs no files.
    std::fs::remove_file(path.with_file_name("models").join("cape.glb")).expect("there");
    let mut cursor = MessageCursor::<CheckpointTaken>::default();
    let mut taken = None;
    let mut goes_on = true;
    while goes_on {
        goes_on = runner.step();
        let messages = runner.world().resource::<Messages<CheckpointTaken>>();
        taken = cursor.read(messages).last().map(|taken| taken.checkpoint.clone()).or(taken);
    }
    let whole = runner.report();
    assert!(whole.passed(), "{}", whole.complaint());
    let bytes = taken.expect("it was due").to_bytes().expect("small enough");
    let checkpoint = Checkpoint::from_bytes(&bytes).expect("just written");
    let rest = SceneRunner::resume(&checkpoint).expect("a good checkpoint").run();
    assert_eq!((rest.state_hash, rest.verdicts), (whole.state_hash, whole.verdicts));
}

#[test]
fn a_scene_with_a_mesh_is_loaded_as_an_asset() {
    let path = scene_with_cape("asset", &of_body(CAPE_BODY));
    let folder = path.parent().expect("its folder").to_string_lossy().into_owned();
    let mut app = App::new();
    let assets = AssetPlugin { file_path: folder, ..default() };
    app.add_plugins((MinimalPlugins, assets, DrapePlugins::default(), SceneAssetPlugin));
    app.init_asset_loader::<SceneScriptLoader>();
    app.finish();
    app.cleanup();
    let scene: Handle<SceneScript> = app.world().resource::<AssetServer>().load("cape.scene.ron");
    // However long a busy machine takes to read the file.
    loop {
        app.update();
        match app.world().resource::<AssetServer>().load_state(&scene) {
            LoadState::Loaded => break,
            LoadState::Failed(error) => panic!("{error}"),
            _ => std::thread::sleep(core::time::Duration::from_millis(1)),
        }
    }
    let script = app.world().resource::<Assets<SceneScript>>().get(&scene).expect("loaded").clone();
    assert_eq!(script, SceneScript::load(&path).expect("a good scene"));
}

proptest! {
    #![proptest_config(random::cases(200))]

    /// What is broken is refused, or is a mesh all the same; never a panic.
    #[test]
    fn a_file_that_is_broken_at_random_is_refused(
        cut in 0..CAPE.len(),
        flips in proptest::collection::vec((0..9000_usize, any::<u8>()), 0..6),
        is_cut in any::<bool>(),
        case in any::<u64>(),
    ) {
        let mut bytes = CAPE.to_vec();
        for (place, flip) in flips {
            bytes[place] ^= flip;
        }
        if is_cut {
            bytes.truncate(cut);
        }
        let path = scene_with_cape(&format!("broken_{}", case % 4), &of_body(CAPE_BODY));
        std::fs::write(path.with_file_name("models").join("cape.glb"), bytes).expect("written");
        if let Err(error) = SceneScript::load(path) {
            prop_assert!(error.field.starts_with("bodies.it"), "{}", error);
        }
    }
}
