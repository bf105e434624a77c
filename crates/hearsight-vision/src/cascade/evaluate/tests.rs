use super::super::level::{Layout, Shape};
use super::super::{Cascade, Feature, Node, Weighted};
use super::*;
use hearsight_core::GrayView;

/// Stages of random trees of one to four nodes over random features of three rectangles, upright and tilted.
fn cascade(next: &mut impl FnMut() -> usize) -> Cascade {
    let (width, height) = (12, 10);
    let mut cascade = Cascade {
        width,
        height,
        stages: Vec::new(),
        trees: Vec::new(),
        nodes: Vec::new(),
        leaves: Vec::new(),
        features: Vec::new(),
    };
    for _ in 0..4 {
        cascade.stages.push(Stage {
            first_tree: cascade.trees.len(),
            trees: 6,
            threshold: -0.3,
        });
        for _ in 0..6 {
            let nodes = 1 + next() % 4;
            let tree = Tree {
                first_node: cascade.nodes.len(),
                nodes,
                first_leaf: cascade.leaves.len(),
            };
            cascade.trees.push(tree);
            for at in 0..nodes {
                let tilted = next().is_multiple_of(3);
                let rectangle = || Weighted {
                    x: 4,
                    y: 1,
                    width: 3,
                    height: 4,
                    weight: -1.0,
                };
                let mut rectangles = [rectangle(), rectangle(), rectangle()];
                for rectangle in &mut rectangles {
                    (rectangle.y, rectangle.width) = (next() % 3, 1 + next() % 3);
                    (rectangle.height, rectangle.weight) = (1 + next() % 4, (next() % 7) as f32 - 3.0);
                }
                cascade.features.push(Feature { tilted, rectangles });
                let leaf = |number: usize| -(number as i32);
                let later = if at + 1 < nodes {
                    at as i32 + 1
                } else {
                    leaf(nodes)
                };
                let children = if next().is_multiple_of(2) {
                    (leaf(at), later)
                } else {
                    (later, leaf(at))
                };
                cascade.nodes.push(Node {
                    feature: cascade.features.len() - 1,
                    threshold: (next() % 200) as f32 * 1e-4 - 0.01,
                    left: children.0,
                    right: children.1,
                });
            }
            cascade
                .leaves
                .extend((0..=nodes).map(|_| (next() % 100) as f32 * 0.01 - 0.5));
        }
    }
    cascade
}

#[test]
fn one_by_one_in_groups_and_in_registers_windows_have_the_same_sums() {
    let mut state = 11_u32;
    let mut next = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as usize
    };
    let cascade = cascade(&mut next);
    let (width, height) = (60, 24);
    let data: Vec<u8> = (0..width * height).map(|_| next() as u8).collect();
    let shape = Shape::new(width, height, cascade.is_tilted());
    let mut results = vec![[0.0; LANES]; 4];
    for (layout, step) in [(Layout::Every, 1), (Layout::Second, 2)] {
        let plan = Plan::new(&cascade, shape, layout);
        let mut level = Level::default();
        level.compute(
            GrayView {
                width,
                height,
                data: &data,
            },
            shape,
            layout,
        );
        for row in [0, 3, height - cascade.height] {
            let base = row * shape.stride;
            let windows = (width - cascade.width) / step + 1;
            let mut scale = [0.0; LANES];
            scales(&plan, &level, base, &mut scale);
            for stage in &plan.stages {
                let mut sums = [0.0; LANES];
                let passed = run_stage(&plan, stage, &level.sums, base, &scale, &mut results, &mut sums);
                for lane in 0..windows.min(LANES) {
                    let sum = stage_sum(&plan, stage, &level.sums, base + lane, scale[lane]);
                    assert_eq!(sum, sums[lane], "window {lane} of row {row}");
                    assert_eq!(passed >> lane & 1 == 1, sum >= f64::from(stage.threshold));
                }
                #[cfg(target_arch = "x86_64")]
                if std::arch::is_x86_feature_detected!("avx2") {
                    let mut fast = [0.0; LANES];
                    #[expect(unsafe_code, reason = "calling a function compiled for AVX2")]
                    // SAFETY: the processor has AVX2, as just checked.
                    let fast_passed = unsafe {
                        evaluate_avx2::run_stage(
                            &plan,
                            stage,
                            &level.sums,
                            base,
                            &scale,
                            &mut results,
                            &mut fast,
                        )
                    };
                    assert_eq!((fast_passed, fast), (passed, sums));
                }
            }
        }
    }
}
