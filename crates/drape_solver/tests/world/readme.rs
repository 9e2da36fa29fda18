//! The README shows the example as it is.

#[test]
fn the_readme_shows_the_example_curtain() {
    let readme = include_str!("../../README.md");
    let example = include_str!("../../examples/curtain.rs");
    let (_, code) = example.split_once("\n\n").expect("a head and code");
    assert!(readme.contains(code), "README.md must hold the code of examples/curtain.rs");
}
