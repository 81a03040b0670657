//! [`Calibration`]: the sizes of batches from which on a GPU pays, measured on the machine itself
//! and kept as three lines of text.

use crate::error::CalibrationError;
use std::fmt;
use std::str::FromStr;

/// The sizes of batches from which on [`super::Backend::Auto`] uses the GPU; see [`super::Batch::calibrate`]. Wrong
/// sizes cost time, but change no answer.
///
/// Its text has the lines `adapter = NAME`, `jobs = N` and `tests = N`, where N may be `never`. The program `medial`
/// (features `cli` and `gpu`) measures and writes it:
///
/// ```text
/// medial calibrate body.ma -o gpu.txt
/// ```
/// ```no_run
/// use rapier3d_medial::batch::{Backend, Batch, Calibration};
/// use rapier3d_medial::prelude::*;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let kept: Calibration = std::fs::read_to_string("gpu.txt")?.parse()?;
/// let mut batch = Batch::new(Backend::Auto);
/// if !batch.calibrate(&kept) {
///     println!("not measured on this adapter");
/// }
/// let pipeline = MedialPipeline::with_batch(MedialOptions::default(), batch);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Calibration {
    /// Name of the GPU that it was measured on ([`super::gpu::Gpu::name`]).
    pub adapter: String,
    /// Smallest number of mesh pairs in a batch for the GPU; `None` if the CPU is always faster.
    pub jobs: Option<usize>,
    /// Smallest number of elementary tests in a batch for the GPU; `None` if the CPU is always faster.
    pub tests: Option<usize>,
}

/// Sizes from which a GPU is asked; `None`: never.
#[cfg(feature = "gpu")]
#[derive(Clone, Copy)]
pub(super) struct Least {
    /// Mesh pairs in a batch.
    pub(super) jobs: Option<usize>,
    /// Elementary tests in a batch.
    pub(super) tests: Option<usize>,
}

impl fmt::Display for Calibration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = |n: Option<usize>| n.map_or("never".to_owned(), |n| n.to_string());
        writeln!(f, "adapter = {}", self.adapter)?;
        writeln!(f, "jobs = {}", size(self.jobs))?;
        writeln!(f, "tests = {}", size(self.tests))
    }
}

impl FromStr for Calibration {
    type Err = CalibrationError;

    fn from_str(text: &str) -> Result<Self, CalibrationError> {
        let (mut adapter, mut jobs, mut tests) = (None, None, None);
        for (index, line) in text.lines().enumerate() {
            let refused = || CalibrationError::Line {
                number: index + 1,
                text: line.to_owned(),
            };
            if line.trim().is_empty() {
                continue;
            }
            let (name, value) = line.split_once('=').ok_or_else(refused)?;
            let value = value.trim();
            let size = || match value {
                "never" => Ok(None),
                number => number.parse().map(Some).map_err(|_| refused()),
            };
            match name.trim() {
                "adapter" => adapter = Some(value.to_owned()),
                "jobs" => jobs = Some(size()?),
                "tests" => tests = Some(size()?),
                _ => return Err(refused()),
            }
        }
        let missing = |what| CalibrationError::Missing { what };
        Ok(Self {
            adapter: adapter.ok_or_else(|| missing("adapter"))?,
            jobs: jobs.ok_or_else(|| missing("jobs"))?,
            tests: tests.ok_or_else(|| missing("tests"))?,
        })
    }
}

#[cfg(not(target_arch = "wasm32"))]
mod measure {
    use super::Calibration;
    use crate::batch::cpu;
    use crate::batch::gpu::{Gpu, Proposals};
    use crate::batch::job::{Job, PairJob};
    use crate::elementary::bracket::Limits;
    use crate::elementary::many::{Lanes, brackets};
    use crate::elementary::path::LinearPath;
    use crate::elementary::test_list::Domain;
    use crate::error::GpuError;
    use crate::math::lane::Vec3;
    use crate::math::tolerance;
    use crate::math::{Pose, Real, Vector};
    use crate::medial::MedialMesh;
    use pollster::block_on;
    use std::hint::black_box;
    use web_time::Instant;

    /// Batches tried, in powers of two: of jobs, and of tests.
    const SIZES: [[u32; 2]; 2] = [[0, 12], [8, 19]];

    /// Repetitions of each size, on CPU and GPU in turn; the fastest of each counts.
    const ROUNDS: usize = 3;

    impl Calibration {
        /// Measures on a GPU with pairs of one mesh, which should be typical of the scene. Takes some seconds, and
        /// blocks.
        ///
        /// # Errors
        /// [`GpuError`] if the GPU fails.
        pub fn measure(gpu: &mut Gpu, mesh: &MedialMesh) -> Result<Self, GpuError> {
            let mut proposals = Proposals::default();
            let jobs = smallest(SIZES[0], |count| {
                let jobs = pairs(mesh, count);
                let sweeps: Vec<_> = jobs.iter().filter_map(Job::sweep).collect();
                race(
                    || drop(black_box(cpu::run(&jobs))),
                    || {
                        block_on(gpu.propose(&sweeps, &mut proposals))?;
                        let open = jobs
                            .iter()
                            .zip(proposals.iter())
                            .filter(|(_, p)| !p.is_free());
                        let open: Vec<_> = open.map(|(job, _)| job).collect();
                        drop(black_box(cpu::run(&open)));
                        Ok(())
                    },
                )
            })?;
            let limits = Limits {
                tolerance: tolerance::TOLERANCE,
                time_tolerance: tolerance::TIME_TOLERANCE,
                start: 0.0,
                horizon: 1.0,
                max_iterations: tolerance::MAX_ITERATIONS,
            };
            let on_cpu = |paths: &[_]| {
                drop(black_box(brackets(
                    paths,
                    Domain::Box,
                    &limits,
                    Lanes::Fastest,
                )));
            };
            let mut free = Vec::new();
            let tests = smallest(SIZES[1], |count| {
                let mut random = Random(2);
                let paths: Vec<_> = (0..count).map(|_| path(&mut random)).collect();
                race(
                    || on_cpu(&paths),
                    || {
                        let asked = gpu.prove(&paths, Domain::Box, limits.tolerance, &mut free);
                        block_on(asked)?;
                        let open = paths.iter().zip(&free);
                        let open = open.filter(|(_, free)| !**free);
                        on_cpu(&open.map(|(path, _)| *path).collect::<Vec<_>>());
                        Ok(())
                    },
                )
            })?;
            Ok(Self {
                adapter: gpu.name().to_owned(),
                jobs,
                tests,
            })
        }
    }

    /// The size from which on the GPU wins at all that are tried.
    fn smallest(
        [first, last]: [u32; 2],
        mut wins: impl FnMut(usize) -> Result<bool, GpuError>,
    ) -> Result<Option<usize>, GpuError> {
        let mut least = None;
        for exponent in (first..=last).rev() {
            match wins(1 << exponent) {
                Ok(true) => least = Some(1 << exponent),
                Ok(false) => break,
                // The device is of no use at this size, though it may be at smaller ones.
                Err(GpuError::TooLarge { .. }) => break,
                Err(error) => return Err(error),
            }
        }
        Ok(least)
    }

    /// Whether the second is faster.
    fn race(
        cpu: impl Fn(),
        mut gpu: impl FnMut() -> Result<(), GpuError>,
    ) -> Result<bool, GpuError> {
        let mut best = [f64::MAX; 2];
        for _ in 0..ROUNDS {
            let clock = Instant::now();
            cpu();
            best[0] = best[0].min(clock.elapsed().as_secs_f64());
            let clock = Instant::now();
            gpu()?;
            best[1] = best[1].min(clock.elapsed().as_secs_f64());
        }
        Ok(best[1] < best[0])
    }

    /// A linear congruential generator (Knuth's constants).
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> Real {
            let (factor, term) = (6_364_136_223_846_793_005, 1_442_695_040_888_963_407);
            self.0 = self.0.wrapping_mul(factor).wrapping_add(term);
            ((self.0 >> 40) as Real / (1u64 << 24) as Real) * 2.0 - 1.0
        }
        fn vector(&mut self) -> Vector {
            Vector::new(self.next(), self.next(), self.next())
        }
    }

    /// Pairs whose boxes are near and that are mostly free, as the hook asks about.
    fn pairs(mesh: &MedialMesh, count: usize) -> Vec<PairJob> {
        let mut random = Random(1);
        let size = (mesh.aabb().maxs - mesh.aabb().mins).length();
        let mut pair = || {
            let away = random.vector().normalize_or_zero() * size;
            let at = away * (0.7 + 0.3 * random.next());
            PairJob {
                mesh1: mesh.clone(),
                mesh2: mesh.clone(),
                pos12: Pose::new(at, random.vector() * 3.0),
                prediction: 0.002 * size,
            }
        };
        (0..count).map(|_| pair()).collect()
    }

    /// Cones a quarter across that fly at each other from 1 away; about half of them meet.
    fn path(random: &mut Random) -> LinearPath<f32> {
        let away = random.vector().normalize_or_zero();
        let fly = random.vector() * 0.3 - away * 1.2;
        let ends = [0; 4].map(|_| random.vector() * 0.25);
        let corners = [[0, 2], [1, 2], [0, 3], [1, 3]];
        let radii = [0; 4].map(|_| 0.08 + 0.06 * random.next());
        LinearPath {
            start: corners.map(|[a, b]| Vec3::from_vector(away + ends[b] - ends[a])),
            rate: [Vec3::from_vector(fly); 4],
            radius: corners.map(|[a, b]| radii[a] + radii[b]),
            size: 0.0,
        }
    }
}
