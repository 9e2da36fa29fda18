//! Cloth whose stiffness differs by direction or from place to place.

use drape_solver::glam::{Vec2, Vec3};
use drape_solver::{BodySettings, ClothMaterial, Island, MeshClothBuilder, Weave};

use crate::common::*;

/// The number of squares along a side of the sheets.
const SIDE: u32 = 16;

/// A sheet of 1 m x 1 m with alternating diagonals that hangs by its upper edge. The texture's V points downwards, rotated by
/// `degrees`.
fn sheet(degrees: f32) -> (MeshClothBuilder, Vec<Vec2>) {
    let at = |column: u32, row: u32| row * (SIDE + 1) + column;
    let place = |column: u32, row: u32| Vec2::new(column as f32, row as f32) / SIDE as f32;
    let all = || (0..=SIDE).flat_map(|row| (0..=SIDE).map(move |column| (column, row)));
    let positions =
        all().map(|(column, row)| place(column, row)).map(|p| Vec3::new(p.x, -p.y, 0.0)).collect();
    let turn = Vec2::from_angle(degrees.to_radians());
    let coordinates = all().map(|(column, row)| turn.rotate(place(column, row))).collect();
    let square = |column: u32, row: u32| {
        let [a, b, c, d] =
            [at(column, row), at(column + 1, row), at(column, row + 1), at(column + 1, row + 1)];
        if (column + row).is_multiple_of(2) { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] }
    };
    let faces = (0..SIDE).flat_map(|row| (0..SIDE).flat_map(move |column| square(column, row)));
    let material =
        ClothMaterial { stretch_stiffness: 0.999, bend_stiffness: 0.1, ..ClothMaterial::default() };
    let builder = MeshClothBuilder::new(positions, faces.collect()).material(material);
    ((0..=SIDE).fold(builder, |builder, column| builder.pin(at(column, 0))), coordinates)
}

/// The sag in metres of the lower edge and of the middle of the sheet at rest.
fn sag(builder: MeshClothBuilder) -> [f32; 2] {
    let settings = BodySettings { substeps: 64, drag: 6.0, tethers: false, ..BodySettings::default() };
    let mut island = Island::of_body(builder.build(settings).expect("valid"));
    let before: Vec<Vec3> = particles(&island).positions().collect();
    run(&mut island, &gravity(FRAME), 6.0);
    let way = |at: Vec3| {
        let i = (0..before.len()).min_by(|&a, &b| before[a].distance(at).total_cmp(&before[b].distance(at)));
        let i = i.expect("a particle");
        before[i].y - particles(&island).position(i).y
    };
    [way(Vec3::new(0.5, -1.0, 0.0)), way(Vec3::new(0.5, -0.5, 0.0))]
}

/// A sheet that hangs by its soft weft sags more than by its warp, and on the bias it sags most.
#[test]
fn a_sheet_hangs_lower_by_its_softer_threads() {
    let woven = |degrees: f32| {
        let (builder, coordinates) = sheet(degrees);
        sag(builder.weave(Weave { coordinates, weft_stiffness: 0.99, bias_stiffness: 0.9 }))[0]
    };
    let alike = sag(sheet(0.0).0)[0];
    let [warp, bias, weft] = [0.0, 45.0, 90.0].map(woven);
    println!(
        "law: a sheet sags by {alike} m; woven {warp} m by its warp, {weft} m by its weft, {bias} m on the bias"
    );
    // The weft has ten times the compliance.
    assert!(weft > 3.0 * warp, "{weft} m by the weft, {warp} m by the warp");
    assert!(bias > 1.5 * weft, "{bias} m on the bias");
    assert!(warp > alike, "what lies aslant helps less");
}

/// In a sheet painted black below the middle the lower half sags, and the upper half does not.
#[test]
fn a_sheet_gives_way_where_it_is_painted_dark() {
    let paint = |dark: f32| {
        let rows = (0..=SIDE).flat_map(|row| (0..=SIDE).map(move |_| row));
        rows.map(move |row| if row > SIDE / 2 { dark } else { 1.0 })
    };
    let of = |dark: f32| sag(sheet(0.0).0.painted_stiffness(paint(dark).collect()));
    let [white, grey, dark] = [1.0, 0.8, 0.6].map(of);
    println!("law: lower edge and middle sag by {white:?} m, {grey:?} m, {dark:?} m");
    assert_eq!(white, sag(sheet(0.0).0), "white paint changes nothing");
    assert!(dark[0] > 2.0 * grey[0] && grey[0] > 2.0 * white[0]);
    assert!(dark[1] < 1.5 * white[1], "the upper half is as it was");
}
