use hearsight_sim::simulation::Simulation;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let world = hearsight_sim::scenario::load(args[1].as_ref(), &vec![]).unwrap();
    let simulation = Simulation::new(world).unwrap();
    let camera: usize = args[2].parse().unwrap();
    let wanted: Vec<u64> = args[4..]
        .iter()
        .map(|t| (t.parse::<f64>().unwrap() * simulation.world().cameras[camera].rate_hz) as u64)
        .collect();
    let mut source = simulation.camera(camera);
    let begun = std::time::Instant::now();
    let mut n = 0;
    while let Some((frame, picture)) = source.shoot() {
        n += 1;
        if wanted.contains(&frame) {
            let (mut rgb, mut luma) = (vec![], vec![]);
            picture.to_rgb(&mut rgb, &mut luma);
            image::RgbImage::from_raw(picture.width as u32, picture.height as u32, rgb)
                .unwrap()
                .save(format!("{}-{frame}.png", args[3]))
                .unwrap();
            println!("{frame} {:?}", picture.sights);
        }
        if frame > *wanted.iter().max().unwrap() {
            break;
        }
    }
    println!("{} frames/s", n as f64 / begun.elapsed().as_secs_f64());
}
