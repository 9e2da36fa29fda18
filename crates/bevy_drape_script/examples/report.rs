//! Throwaway.
fn main() {
    for path in std::env::args().skip(1) {
        print!("{}", bevy_drape_script::run_scene(path));
    }
}
