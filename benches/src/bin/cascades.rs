//! How often OpenCV's cascades find rendered people in cluttered rooms, over the angle at which they are seen.
//!
//! ```text
//! cascades [PEOPLE [SEED [DIRECTORY]]]     prints the curves; writes the first pictures to the directory as PPM
//! ```
//!
//! Every person is seen at one angle, in a room of their own. Cascades of Debian's package opencv-data; scale step 1.1,
//! more than 3 neighbours, windows of 30 pixels or more.

use hearsight_benches::{Failure, curves, sittings};
use std::io::Write;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let people = arguments.first().map_or(Ok(240), |text| text.parse())?;
    let seed = arguments.get(1).map_or(Ok(1), |text| text.parse())?;
    let curves = curves(people, seed)?;
    print!("{curves}");
    if let Some(directory) = arguments.get(2) {
        for (number, (sitting, picture)) in sittings(people.min(60), seed).into_iter().enumerate() {
            let (mut rgb, mut luma) = (Vec::new(), Vec::new());
            picture.to_rgb(&mut rgb, &mut luma);
            let name = format!("{directory}/{number:03}_{:+.0}.ppm", sitting.yaw_degrees);
            let mut file = std::fs::File::create(name)?;
            write!(file, "P6\n{} {}\n255\n", picture.width, picture.height)?;
            file.write_all(&rgb)?;
        }
    }
    Ok(())
}
