//! The cape of the file in the repository, loaded by Bevy, dressed as the guide says, moved by the file's animations.

use bevy::gltf::GltfLoaderSettings;
use bevy::gltf::convert_coordinates::GltfConvertCoordinates;
use bevy::gltf::{GltfMesh, GltfPlugin};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::mesh::{MeshVertexAttribute, VertexFormat};
use bevy::prelude::*;
use bevy::world_serialization::WorldSerializationPlugin;
use bevy_drape::prelude::*;
use bevy_drape::render::{PaintChannel, WeldedVertices};
use bevy_drape::transform::MovedByFrame;
use bevy_skein::SkeinPlugin;
use drape_examples::character::{BONES, CAPE, Character};
use drape_examples::view::gltf_files::wait_for_files;

use crate::cape_gltf::{FILE, dress};
use crate::measure::{Skin, Worst, measure};
use crate::*;

/// The longest time that a cape put on in mid-stride, with a leg through it, may take to get clear, in seconds.
const DRESSING: f32 = 0.25;

/// The file's assets, kept alive: Bevy spawns the scenes of a file again if it loads it again.
struct File {
    whole: Handle<Gltf>,
    scene: Handle<WorldAsset>,
    walk: Handle<AnimationClip>,
    run: Handle<AnimationClip>,
}

impl File {
    fn load(app: &mut App) -> Self {
        Self::load_with(app, FILE, |_| ())
    }

    /// Loads the file as a whole. Its scene and its two animations were once asked for one by one: Bevy then loads the file three
    /// times, and where a busy machine ended a load late, the scene was spawned again in the middle of the test.
    fn load_with(
        app: &mut App,
        file: &'static str,
        set: impl Fn(&mut GltfLoaderSettings) + Send + Sync + Clone + 'static,
    ) -> Self {
        let assets = app.world().resource::<AssetServer>();
        let whole: Handle<Gltf> = assets.load_builder().with_settings(set).load(file);
        // However long a busy machine takes to read the file.
        while !app.world().resource::<Assets<Gltf>>().contains(&whole) {
            let state = app.world().resource::<AssetServer>().load_state(&whole);
            assert!(!state.is_failed(), "{state:?}");
            std::thread::sleep(Duration::from_millis(1));
            app.update();
        }
        let Gltf { scenes, named_animations, .. } =
            app.world().resource::<Assets<Gltf>>().get(&whole).expect("loaded");
        let [walk, run] = ["Walk", "Run"].map(|name| named_animations[name].clone());
        Self { scene: scenes[0].clone(), walk, run, whole }
    }
}

fn gltf_app() -> App {
    gltf_app_with(|_| ())
}

/// An app that loads files, with what is added before plugins are finished.
fn gltf_app_with(add: impl Fn(&mut App)) -> App {
    let mut app = app();
    let attributes = GltfPlugin::default()
        .add_custom_vertex_attribute("PINS", MeshVertexAttribute::new("Pins", 987, VertexFormat::Float32))
        .add_custom_vertex_attribute(
            "LIMITS",
            MeshVertexAttribute::new("Limits", 986, VertexFormat::Float32),
        );
    app.add_plugins((ImagePlugin::default(), WorldSerializationPlugin, attributes, AnimationPlugin))
        .init_resource::<Skin>()
        .init_resource::<Worst>()
        .add_systems(FixedLast, measure.run_if(resource_exists::<Character>));
    add(&mut app);
    app.finish();
    app.cleanup();
    frames(&mut app, 0.0);
    app
}

/// Spawns the scene, and waits until it is there.
fn spawn(app: &mut App, scene: &Handle<WorldAsset>) -> Character {
    let root = app.world_mut().spawn(WorldAssetRoot(scene.clone())).observe(dress).id();
    spawned(app, root)
}

/// Waits until the scene is there.
fn spawned(app: &mut App, root: Entity) -> Character {
    app.update();
    wait_for_files(app).expect("the file");
    character(app, root)
}

/// The descendant with this name, and no other.
fn named(app: &mut App, root: Entity, name: &str) -> Entity {
    let world = app.world_mut();
    let mut state = world.query::<&Children>();
    let children = state.query(world);
    let found: Vec<Entity> = children
        .iter_descendants(root)
        .filter(|&entity| world.get::<Name>(entity).is_some_and(|known| known.as_str() == name))
        .collect();
    assert_eq!(found.len(), 1, "{name}");
    found[0]
}

/// The spawned scene, in the form that `measure` takes.
fn character(app: &mut App, root: Entity) -> Character {
    let mut character = Character::default();
    character.root = root;
    character.cape = named(app, root, "Cape.cloth");
    for (bone, ..) in BONES {
        let joint = named(app, root, bone);
        character.joints.push(joint);
        let children = app.world().get::<Children>(joint).expect("a capsule");
        let capsule = children.iter().find(|&child| app.world().get::<Obstacle>(child).is_some());
        character.capsules.push(capsule.expect("a capsule"));
    }
    character
}

/// Plays an animation over and over, as a game does.
fn play(app: &mut App, root: Entity, clip: &Handle<AnimationClip>) {
    let (graph, node) = AnimationGraph::from_clip(clip.clone());
    let graph = app.world_mut().resource_mut::<Assets<AnimationGraph>>().add(graph);
    let player = named(app, root, "Character");
    let mut player = app.world_mut().entity_mut(player);
    player.insert(AnimationGraphHandle(graph));
    player.get_mut::<AnimationPlayer>().expect("Bevy's loader puts it there").play(node).repeat();
}

/// Goes on for some seconds. The root goes ahead at `speed`. Tells how far a thigh has turned meanwhile, in radians.
fn go(app: &mut App, character: &Character, fps: f32, seconds: f32, speed: f32) -> f32 {
    frames(app, f64::from(1.0 / fps));
    let mut turned = [f32::INFINITY, f32::NEG_INFINITY];
    for _ in 0..(seconds * fps) as u32 {
        let mut root = app.world_mut().get_mut::<Transform>(character.root).expect("a root");
        root.translation.z -= speed / fps;
        app.update();
        let thigh = app.world().get::<Transform>(character.joints[6]).expect("a thigh").rotation;
        let angle = thigh.to_euler(EulerRot::XYZ).0;
        turned = [turned[0].min(angle), turned[1].max(angle)];
    }
    turned[1] - turned[0]
}

fn worst(app: &App) -> Worst {
    *app.world().resource::<Worst>()
}

fn assert_worn(name: &str, worst: &Worst) {
    println!("cape: {name}: {worst:?}");
    assert!(worst.pin_error < 1e-3, "{name}: a pin is {} m off", worst.pin_error);
    assert!(worst.excess < 1e-3, "{name}: {} m beyond a limit", worst.excess);
    assert!(worst.depth < 2e-3, "{name}: {} m deep", worst.depth);
    assert_eq!(worst.uncounted, 0, "{name}");
    assert!(worst.away < 1.5, "{name}: {} m from the hips", worst.away);
}

fn has_no_refusal(app: &App) {
    let refused: Vec<_> = app.world().resource::<Refusals>().iter().collect();
    assert!(refused.is_empty(), "{refused:?}");
}

#[test]
fn a_cape_from_a_file_is_built_as_it_is_painted() {
    let mut app = gltf_app();
    let file = File::load(&mut app);
    let character = spawn(&mut app, &file.scene);
    one_step_a_frame(&mut app);
    app.update();
    has_no_refusal(&app);
    let body = particles(&app, character.cape);
    assert_eq!(body.len(), CAPE[0] * CAPE[1]);
    let welded = app.world().get::<WeldedVertices>(character.cape).expect("built");
    for vertex in 0..welded.vertex_count() {
        let i = welded.particle(vertex).expect("a corner");
        assert_eq!(body.is_pinned(i), vertex < CAPE[0], "vertex {vertex}: the collar, which is red");
        assert_eq!(body.motion_limit(i).is_some(), vertex >= CAPE[0]);
    }
    let cape = app.world().entity(character.cape);
    assert!(!cape.contains::<SkinnedMesh>());
    let shown = cape.get::<Mesh3d>().expect("a mesh");
    let shown = app.world().resource::<Assets<Mesh>>().get(shown).expect("loaded");
    for attribute in [Mesh::ATTRIBUTE_JOINT_INDEX, Mesh::ATTRIBUTE_JOINT_WEIGHT, Mesh::ATTRIBUTE_COLOR] {
        assert!(!shown.contains_attribute(attribute), "{attribute:?}");
    }
    let figure = named(&mut app, character.root, "Figure.skin");
    assert!(app.world().get::<SkinnedMesh>(figure).is_some(), "the figure is left alone");
}

/// The file that the steps of `docs/blender.md` export, taken by Blender itself (`.ci/blender`). Blender writes more vertices than the
/// cape has corners, weights of its own, and animations frame by frame, in another order.
const FROM_BLENDER: &str = "models/cape_from_blender.glb";

/// The skin of the cape in that file, with its own joints.
fn skin_from_blender(app: &mut App, file: &File, character: &Character) -> Skin {
    let figure = named(app, character.root, "Figure.skin");
    let world = app.world();
    let skin = world.get::<SkinnedMesh>(figure).expect("the figure keeps it");
    let inverses = world.resource::<Assets<SkinnedMeshInverseBindposes>>();
    let inverses = inverses.get(&skin.inverse_bindposes).expect("loaded");
    let bone = |joint: &Entity| character.joints.iter().position(|known| known == joint).expect("a bone");
    let whole = world.resource::<Assets<Gltf>>().get(&file.whole).expect("loaded");
    let cape = world.resource::<Assets<GltfMesh>>().get(&whole.named_meshes["Cape"]).expect("loaded");
    let mesh = world.resource::<Assets<Mesh>>().get(&cape.primitives[0].mesh).expect("loaded");
    Skin::new(mesh, skin.joints.iter().map(bone).zip(inverses.iter().copied()))
}

#[test]
fn a_cape_that_blender_exported_is_worn_by_who_walks_and_by_who_runs() {
    let mut app = gltf_app();
    let file = File::load_with(&mut app, FROM_BLENDER, |_| ());
    for (name, clip, speed, reach) in [("walks", &file.walk, 1.5, 0.5), ("runs", &file.run, 5.0, 1.0)] {
        let character = spawn(&mut app, &file.scene);
        let skin = skin_from_blender(&mut app, &file, &character);
        app.insert_resource(skin);
        play(&mut app, character.root, clip);
        go(&mut app, &character, 60.0, DRESSING, speed);
        let body = particles(&app, character.cape);
        assert_eq!(body.len(), CAPE[0] * CAPE[1]);
        assert_eq!((0..body.len()).filter(|&i| body.is_pinned(i)).count(), CAPE[0], "the collar");
        app.insert_resource(character.clone());
        app.insert_resource(Worst::default());
        let turned = go(&mut app, &character, 60.0, 8.0, speed);
        assert!(turned > reach, "a thigh turns by {turned} rad");
        let worst = worst(&app);
        assert_worn(&format!("from Blender, {name}"), &worst);
        assert!(worst.steps > 470 && worst.speed < speed + 10.0, "{worst:?}");
        has_no_refusal(&app);
        app.world_mut().remove_resource::<Character>();
        app.world_mut().despawn(character.root);
    }
}

/// The file has the same paint in attributes of its own. Half the full distance makes half of each limit.
#[test]
fn attributes_that_blender_exported_are_paint() {
    let mut app = gltf_app();
    let file = File::load_with(&mut app, FROM_BLENDER, |_| ());
    let character = spawn(&mut app, &file.scene);
    one_step_a_frame(&mut app);
    let coloured = particles(&app, character.cape).clone();
    let channel = |name: &str| Some(PaintChannel::Attribute(name.into()));
    let paint = ClothPaint {
        pins: channel("Pins"),
        max_distance: channel("Limits"),
        full_distance: 0.35,
        ..default()
    };
    app.world_mut().get_mut::<ClothMesh>(character.cape).expect("dressed").paint = paint;
    app.update();
    has_no_refusal(&app);
    let body = particles(&app, character.cape);
    let limit = |body: &Particles, i| body.motion_limit(i).map_or(0.0, |(_, reach)| reach);
    for i in 0..body.len() {
        assert_eq!(body.is_pinned(i), coloured.is_pinned(i), "particle {i}");
        // Blender exports colours in 16 bits.
        assert!((2.0 * limit(body, i) - limit(&coloured, i)).abs() < 2e-5, "particle {i}");
    }
    assert!((0..body.len()).any(|i| limit(body, i) > 0.3));
}

/// An artist can put components on meshes in Blender: Skein inserts them, and no code is needed to dress anybody.
#[test]
fn components_from_blender_dress_a_cape_by_themselves() {
    let mut app = gltf_app_with(|app| _ = app.add_plugins(SkeinPlugin::default()));
    let file = File::load_with(&mut app, FROM_BLENDER, |_| ());
    let root = app.world_mut().spawn((WorldAssetRoot(file.scene.clone()), MovedByFrame)).id();
    let character = spawned(&mut app, root);
    let skin = skin_from_blender(&mut app, &file, &character);
    app.insert_resource(skin);
    let cape = app.world().entity(character.cape);
    let paint = &cape.get::<ClothMesh>().expect("in the file").paint;
    assert_eq!((paint.full_distance, &paint.max_distance), (0.7, &Some(PaintChannel::Green)));
    assert_eq!(paint.pins, ClothPaint::default().pins, "a field that the file does not have");
    assert_eq!(cape.get::<Fabric>().expect("in the file").areal_density, 0.3);
    play(&mut app, character.root, &file.walk);
    go(&mut app, &character, 60.0, DRESSING, 1.5);
    app.insert_resource(character.clone());
    app.insert_resource(Worst::default());
    let turned = go(&mut app, &character, 60.0, 4.0, 1.5);
    assert!(turned > 0.5, "a thigh turns by {turned} rad");
    let worst = worst(&app);
    assert_worn("dressed in Blender", &worst);
    assert!(worst.steps > 230, "{worst:?}");
    has_no_refusal(&app);
}

#[test]
fn a_cape_from_a_file_is_worn_by_who_walks_and_by_who_runs() {
    for fps in [30.0, 60.0, 144.0] {
        let mut app = gltf_app();
        let file = File::load(&mut app);
        for (name, clip, speed, reach) in [("walks", &file.walk, 1.5, 0.5), ("runs", &file.run, 5.0, 1.0)] {
            let character = spawn(&mut app, &file.scene);
            play(&mut app, character.root, clip);
            app.insert_resource(character.clone());
            go(&mut app, &character, fps, DRESSING, speed);
            let dressed = worst(&app);
            println!("cape: from the file, {name} at {fps} fps, dressed: {dressed:?}");
            assert!(dressed.pin_error < 1e-3 && dressed.excess < 1e-3);
            assert!(dressed.speed < 35.0, "{} m/s", dressed.speed);
            app.insert_resource(Worst::default());
            let turned = go(&mut app, &character, fps, 8.0, speed);
            assert!(turned > reach, "a thigh turns by {turned} rad");
            let worst = worst(&app);
            assert_worn(&format!("from the file, {name} at {fps} fps"), &worst);
            assert!(worst.steps > 470, "{} steps", worst.steps);
            assert!(worst.speed < speed + 10.0, "{} m/s", worst.speed);
            has_no_refusal(&app);
            app.world_mut().despawn(character.root);
        }
    }
}

#[test]
fn a_character_from_a_file_that_is_teleported_takes_its_cape_along() {
    let mut app = gltf_app();
    let file = File::load(&mut app);
    let character = spawn(&mut app, &file.scene);
    play(&mut app, character.root, &file.run);
    go(&mut app, &character, 60.0, 2.0, 5.0);
    app.insert_resource(character.clone());
    let mut place = app.world_mut().get_mut::<Transform>(character.root).expect("a root");
    place.translation += Vec3::new(4.0, 0.0, -3.0);
    place.rotate_y(2.0);
    go(&mut app, &character, 60.0, 2.0, 5.0);
    let worst = worst(&app);
    assert_worn("from the file, teleported by 5 m", &worst);
    assert!(worst.speed < 20.0, "{} m/s", worst.speed);
    assert!(worst.rms_stretch < 0.1, "stretched by {}", worst.rms_stretch);
}

#[test]
fn a_character_from_a_file_comes_and_goes_and_leaves_nothing_behind() {
    let mut app = gltf_app();
    let file = File::load(&mut app);
    let mut before = None;
    for _ in 0..3 {
        let [first, second] = [(); 2].map(|()| spawn(&mut app, &file.scene));
        app.world_mut().get_mut::<Transform>(second.root).expect("a root").translation.x = 3.0;
        play(&mut app, first.root, &file.walk);
        app.insert_resource(first.clone());
        go(&mut app, &first, 60.0, DRESSING, 1.5);
        app.insert_resource(Worst::default());
        go(&mut app, &first, 60.0, 1.0, 1.5);
        assert_worn("from the file, again", &worst(&app));
        for cape in [first.cape, second.cape] {
            assert_eq!(particles(&app, cape).len(), CAPE[0] * CAPE[1]);
        }
        has_no_refusal(&app);
        app.world_mut().remove_resource::<Character>();
        // One goes as a whole, of the other the scene alone.
        app.world_mut().despawn(first.root);
        app.world_mut().entity_mut(second.root).remove::<WorldAssetRoot>().despawn_children();
        (0..5).for_each(|_| app.update());
        assert_eq!(app.world_mut().query::<&Particles>().iter(app.world()).count(), 0);
        assert_eq!(app.world_mut().query::<&Obstacle>().iter(app.world()).count(), 0);
        app.world_mut().despawn(second.root);
        app.update();
        let now = app.world().entities().count_spawned();
        assert_eq!(*before.get_or_insert(now), now, "entities");
        has_no_refusal(&app);
    }
}

/// A scene whose file was loaded again, as it is when the artist saves it, is another scene.
#[test]
fn a_cape_is_dressed_again_when_its_file_is_loaded_again() {
    let mut app = gltf_app();
    let file = File::load(&mut app);
    let first = spawn(&mut app, &file.scene);
    go(&mut app, &first, 60.0, 0.5, 1.5);
    assert!(app.world().resource::<Assets<Gltf>>().contains(&file.whole));
    app.world().resource::<AssetServer>().reload(FILE);
    frames(&mut app, 0.0);
    // However long a busy machine takes to read the file.
    while app.world().get_entity(first.cape).is_ok() {
        std::thread::sleep(Duration::from_millis(1));
        app.update();
    }
    let again = character(&mut app, first.root);
    assert_ne!(again.cape, first.cape);
    play(&mut app, again.root, &file.walk);
    app.insert_resource(again.clone());
    go(&mut app, &again, 60.0, DRESSING, 1.5);
    app.insert_resource(Worst::default());
    go(&mut app, &again, 60.0, 1.0, 1.5);
    assert_worn("from the file, saved anew", &worst(&app));
    assert_eq!(particles(&app, again.cape).len(), CAPE[0] * CAPE[1]);
    assert_eq!(app.world_mut().query::<&Particles>().iter(app.world()).count(), 1);
    has_no_refusal(&app);
}

/// Bevy can turn files so that what looks along +Z looks along -Z: the root, the meshes, or both.
#[test]
fn a_cape_from_a_file_whose_coordinates_are_converted_is_worn_as_well() {
    for (rotate_scene_entity, rotate_meshes) in [(true, false), (false, true), (true, true)] {
        let mut app = gltf_app();
        let convert = GltfConvertCoordinates { rotate_scene_entity, rotate_meshes };
        let file =
            File::load_with(&mut app, FILE, move |settings| settings.convert_coordinates = Some(convert));
        let character = spawn(&mut app, &file.scene);
        play(&mut app, character.root, &file.walk);
        go(&mut app, &character, 60.0, DRESSING, 1.5);
        app.insert_resource(character.clone());
        go(&mut app, &character, 60.0, 3.0, 1.5);
        assert_worn(&format!("from the file, {convert:?}"), &worst(&app));
        has_no_refusal(&app);
    }
}

#[test]
fn a_file_that_is_not_there_is_told_of() {
    let mut app = gltf_app();
    let scene = app.world().resource::<AssetServer>().load("models/none.glb#Scene0");
    app.world_mut().spawn(WorldAssetRoot(scene));
    app.update();
    let error = wait_for_files(&mut app).expect_err("no such file").to_string();
    assert!(error.contains("models/none.glb"), "{error}");
}

/// The sample that technical artists copy is the code that is tested here.
#[test]
fn the_guide_quotes_the_example() {
    let read = |file: &str| {
        std::fs::read_to_string(format!("{}/../{file}", env!("CARGO_MANIFEST_DIR")))
            .expect("in the repository")
    };
    let (guide, example) = (read("docs/blender.md"), read("examples/cape_gltf.rs"));
    let start = example.find("fn dress").expect("in the example");
    let length = example[start..].find("\n}\n").expect("its end") + 3;
    let quoted = &example[start..start + length];
    assert!(guide.contains(quoted), "`docs/blender.md` has another `dress` than the example:\n{quoted}");
}
