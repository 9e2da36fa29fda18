//! Newcomers copy the sample of the README. It is the example `readme`, which is compiled.

#[test]
fn the_readme_quotes_the_example() {
    let read = |file: &str| {
        let path = format!("{}/../{file}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read_to_string(path).expect("in the repository").replace('\r', "")
    };
    let (readme, example) = (read("README.md"), read("examples/readme.rs"));
    let (_, code) = example.split_once("\n\n").expect("a head, then the code");
    assert!(readme.contains(&format!("```rust,no_run\n{code}```")), "README.md has another sample:\n{code}");
}
