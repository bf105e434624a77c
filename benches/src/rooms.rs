//! Random people in random cluttered rooms, for measuring what detectors make of rendered pictures.

use hearsight_core::camera::Pinhole;
use hearsight_core::{Camera, CameraModel, Pose, WorldPoint};
use hearsight_sim::world::{
    Block, Colour, Hair, Light, Limb, Looks, Material, Pattern, Posture, Setting, Wear,
};
use nalgebra::Vector3;

/// Random numbers by their order (SplitMix64).
#[derive(Clone, Debug)]
pub struct Dice(u64);

/// Somebody before a camera in a room.
#[derive(Clone, Debug)]
pub struct Sitting {
    /// The room.
    pub setting: Setting,
    /// The camera.
    pub camera: Camera,
    /// Who is there.
    pub looks: Looks,
    /// Their posture.
    pub posture: Posture,
    /// Angle between where the face looks and the direction to the camera, seen from above, degrees; positive where
    /// the face is turned to its own left.
    pub yaw_degrees: f64,
    /// Gain that suits the light.
    pub exposure: f64,
}

impl Dice {
    /// Numbers of this seed.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub const fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// Evenly between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// One of these.
    pub fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.bits() as usize % choices.len()]
    }

    /// A colour whose lightness is spread evenly over ratios between two reflectances, and whose channels differ from
    /// it by up to such a share.
    fn colour(&mut self, (low, high): (f64, f64), vivid: f64) -> Colour {
        let lightness = low * (high / low).powf(self.between(0.0, 1.0));
        [0; 3].map(|_| (lightness * self.between(1.0 - vivid, 1.0 + vivid)).min(0.9) as f32)
    }

    fn material(
        &mut self,
        patterns: &[Pattern],
        range: (f64, f64),
        vivid: f64,
        scales_m: (f64, f64),
    ) -> Material {
        let colour = self.colour(range, vivid);
        let other = self.colour(range, vivid);
        Material {
            colour,
            second: [0, 1, 2].map(|channel| 0.5 * (colour[channel] + other[channel])),
            pattern: self.of(patterns),
            scale_m: self.between(scales_m.0, scales_m.1) as f32,
            seed: self.bits(),
        }
    }

    /// Random looks: clothes reflect from 1.5 % (black) to 35 % (light) as most do; all tones of skin and colours of
    /// hair, from linear light that skin and hair reflect.
    pub fn looks(&mut self) -> Looks {
        // From pale to dark; reflectances of skin fall about so.
        let tone = self.between(0.0, 1.0) as f32;
        let pale: Colour = [0.66, 0.42, 0.32];
        let dark: Colour = [0.13, 0.065, 0.04];
        let skin = [0, 1, 2].map(|channel| pale[channel] * (dark[channel] / pale[channel]).powf(tone));
        let hairs: [Colour; 6] = [
            [0.01, 0.009, 0.008],
            [0.03, 0.018, 0.011],
            [0.09, 0.05, 0.025],
            [0.3, 0.2, 0.09],
            [0.2, 0.07, 0.03],
            [0.4, 0.4, 0.4],
        ];
        // Who is dark of skin has dark or grey hair.
        let hair = if tone > 0.6 {
            self.of(&[hairs[0], hairs[1], hairs[5]])
        } else {
            self.of(&hairs)
        };
        let size = self.between(0.94, 1.06);
        use Pattern::{Clouds, Plain, Squares, Stripes};
        Looks {
            height_m: self.between(1.55, 1.92),
            build: self.between(0.85, 1.25),
            head_half_axes_m: [0.098 * size, self.between(0.074, 0.082) * size, 0.117 * size],
            skin,
            hair,
            hair_style: self.of(&[Hair::Short, Hair::Short, Hair::Long, Hair::Bald]),
            eyes: self.of(&[[0.05, 0.03, 0.015], [0.12, 0.18, 0.28], [0.1, 0.14, 0.06]]),
            wear: Wear {
                top: self.material(
                    &[Plain, Plain, Stripes, Squares, Clouds],
                    (0.015, 0.35),
                    0.7,
                    (0.04, 0.2),
                ),
                bottom: self.material(&[Plain], (0.015, 0.2), 0.4, (0.1, 0.2)),
                long_sleeves: self.between(0.0, 1.0) < 0.6,
            },
            face: None,
            seed: self.bits(),
        }
    }

    /// A random room of 6 x 5 x 2.8 m with painted, papered or cluttered walls, which reflect 30 % to 75 % as walls of
    /// rooms that people live in do, and furniture of any colour.
    pub fn setting(&mut self) -> Setting {
        use Pattern::{Clouds, Clutter, Plain, Planks, Squares};
        let wall = |dice: &mut Self| {
            dice.material(&[Plain, Clouds, Clutter, Planks], (0.3, 0.75), 0.15, (0.15, 0.6))
        };
        let surfaces = [
            self.material(&[Planks, Squares, Plain], (0.1, 0.4), 0.2, (0.2, 0.6)),
            self.material(&[Plain], (0.6, 0.8), 0.05, (0.5, 1.0)),
            wall(self),
            wall(self),
            wall(self),
            wall(self),
        ];
        let blocks = (0..5).map(|number| {
            let size_m = [
                self.between(0.4, 1.2),
                self.between(0.3, 0.6),
                self.between(0.5, 2.0),
            ];
            Block {
                name: format!("block {number}"),
                centre: WorldPoint::new(self.between(4.0, 5.8), self.between(0.3, 4.7), size_m[2] / 2.0),
                size_m,
                yaw_rad: self.between(0.0, 3.0),
                material: self.material(&[Plain, Clutter, Planks, Clouds], (0.05, 0.6), 0.5, (0.1, 0.4)),
            }
        });
        let blocks = blocks.collect();
        let lights = (0..3).map(|_| {
            let position = WorldPoint::new(
                self.between(0.5, 5.5),
                self.between(0.5, 4.5),
                self.between(2.2, 2.7),
            );
            let strength = self.between(0.6, 1.6);
            let tint = [1.0, 0.95, 0.85].map(|channel| strength * channel * self.between(0.93, 1.07));
            Light {
                position,
                colour: tint.map(|channel| channel as f32),
            }
        });
        let lights = lights.collect();
        Setting {
            size_m: [6.0, 5.0, 2.8],
            origin: WorldPoint::new(0.0, 0.0, 0.0),
            surfaces,
            blocks,
            lights,
            ambient: [0.45; 3],
        }
    }

    /// Somebody who stands 1.3 to 2.2 m from a camera of 640 x 480 pixels, so that heads are 40 to 70 pixels wide.
    pub fn sitting(&mut self, yaw_degrees: f64) -> Sitting {
        let setting = self.setting();
        let looks = self.looks();
        let eye = WorldPoint::new(
            self.between(0.5, 1.2),
            self.between(1.0, 4.0),
            self.between(1.2, 1.9),
        );
        let distance = self.between(1.3, 2.1);
        let heading = self.between(-0.25, 0.25);
        let ground = [
            eye.0.x + distance * heading.cos(),
            eye.0.y + distance * heading.sin(),
        ];
        let back = heading + std::f64::consts::PI;
        let head_yaw = back + yaw_degrees.to_radians();
        let mut posture = standing(
            &looks,
            ground,
            back + yaw_degrees.to_radians() * self.between(0.3, 1.0),
            head_yaw,
        );
        posture.head_pitch_rad = self.between(-0.12, 0.12);
        posture.head_roll_rad = self.between(-0.08, 0.08);
        posture.mouth_opening = if self.between(0.0, 1.0) < 0.3 {
            self.between(0.0, 1.0)
        } else {
            0.0
        };
        let target = WorldPoint::new(
            ground[0],
            ground[1] + self.between(-0.3, 0.3),
            posture.head.0.z - self.between(0.0, 0.45),
        );
        let focal = 560.0;
        let lens = Pinhole::ideal([focal, focal], [319.5, 239.5]).ok();
        let pose = Pose::looking_at(eye, target).unwrap_or_else(Pose::identity);
        let camera = Camera {
            // The numbers above are a lens's.
            model: CameraModel::Pinhole(lens.unwrap_or_else(|| unreachable!())),
            pose,
            width: 640,
            height: 480,
        };
        Sitting {
            setting,
            camera,
            looks,
            posture,
            yaw_degrees,
            exposure: self.between(0.75, 1.25),
        }
    }
}

/// Somebody who stands upright with hanging arms; yaws as in [`Posture`].
pub fn standing(looks: &Looks, ground: [f64; 2], torso_yaw_rad: f64, head_yaw_rad: f64) -> Posture {
    let tall = looks.height_m;
    let [_, _, up] = looks.head_half_axes_m;
    let forward = Vector3::new(torso_yaw_rad.cos(), torso_yaw_rad.sin(), 0.0);
    let left = Vector3::new(-torso_yaw_rad.sin(), torso_yaw_rad.cos(), 0.0);
    let at = |ahead: f64, aside: f64, height: f64| {
        let place = forward * (ahead * tall) + left * (aside * tall);
        WorldPoint::new(ground[0] + place.x, ground[1] + place.y, height * tall)
    };
    let arm = |side: f64| Limb {
        root: at(0.0, side * 0.108 * looks.build.sqrt(), 0.81),
        joint: at(-0.01, side * 0.128 * looks.build.sqrt(), 0.63),
        end: at(0.03, side * 0.125 * looks.build.sqrt(), 0.485),
    };
    let leg = |side: f64| Limb {
        root: at(0.0, side * 0.052, 0.51),
        joint: at(0.005, side * 0.055, 0.28),
        end: at(-0.01, side * 0.06, 0.045),
    };
    let head = at(0.02, 0.0, 1.0).0 - Vector3::z() * up;
    Posture {
        head: WorldPoint(head),
        head_yaw_rad,
        head_pitch_rad: 0.0,
        head_roll_rad: 0.0,
        neck: at(0.0, 0.0, 0.835),
        pelvis: at(0.0, 0.0, 0.53),
        torso_yaw_rad,
        arms: [arm(1.0), arm(-1.0)],
        legs: [leg(1.0), leg(-1.0)],
        mouth_opening: 0.0,
        blink: 0.0,
    }
}
