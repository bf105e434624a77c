//! Opens a room and prints who speaks: `cargo run --example track -- room.toml`

fn main() -> Result<(), hearsight::EngineError> {
    let path = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "examples/av16.3.toml".to_owned());
    let mut engine = hearsight::Engine::open(hearsight::load(path.as_ref())?)?;
    while let Some(scene) = engine.step() {
        if let Some(speaker) = scene.speaker {
            println!(
                "{:.2} s: track {speaker} of {} speaks",
                scene.time_s,
                scene.tracks.len()
            );
        }
    }
    Ok(())
}
