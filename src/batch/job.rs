//! The jobs that a batch takes, and their answers, which are the same whether a CPU or a GPU computes them.

use crate::elementary::{InitialContact, Paths, Toi, ToiOptions};
use crate::math::tolerance::MAX_ITERATIONS;
use crate::math::{Pose, Real};
use crate::medial::MedialMesh;
use crate::pair::SpherePair;
pub use crate::pair::first_contact::ToiResult;
use crate::pair::first_contact::{Counts, Query};
use parry3d::query::NonlinearRigidMotion;

/// One query of a batch. Its answer depends on the job alone, never on the others in the batch.
pub trait Job: Sync {
    /// Answer to the job.
    type Answer: Send;
    /// The smallest number of jobs for which it pays to wake another thread, which takes some microseconds.
    const PER_THREAD: usize;
    /// Answers this job on the CPU.
    fn answer(&self) -> Self::Answer;
    /// The question that a GPU may be asked about this job; `None` leaves it to the CPU.
    fn sweep(&self) -> Option<Sweep<'_>>;
    /// The answer if nothing comes within the sweep's reach: equal to that of [`Self::answer`], except for the
    /// counts of work.
    fn free(&self) -> Self::Answer;
    /// The answer if of all primitives only these pairs may come within the sweep's reach, in any order, repeatedly or
    /// not: equal to that of [`Self::answer`], except for the counts of work.
    fn answer_near(&self, near: &[[u32; 2]]) -> Self::Answer {
        let _ = near;
        self.answer()
    }
}

impl<J: Job> Job for &J {
    type Answer = J::Answer;
    const PER_THREAD: usize = J::PER_THREAD;
    fn answer(&self) -> Self::Answer {
        J::answer(self)
    }
    fn sweep(&self) -> Option<Sweep<'_>> {
        J::sweep(self)
    }
    fn free(&self) -> Self::Answer {
        J::free(self)
    }
    fn answer_near(&self, near: &[[u32; 2]]) -> Self::Answer {
        J::answer_near(self, near)
    }
}

/// The question whether two meshes come within `reach` of each other in the step.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'a> {
    /// The two meshes.
    pub meshes: [&'a MedialMesh; 2],
    /// Motions of the two meshes, in world space, with velocities per second.
    pub motions: [NonlinearRigidMotion; 2],
    /// Length of the step in seconds; 0 for bodies at rest.
    pub seconds: Real,
    /// Distance that counts as contact, a length; negative lets them overlap that deep.
    pub reach: f64,
    /// Whether it helps to know which primitives may come within reach: [`Job::answer_near`].
    pub lists: bool,
}

/// Asks for the contacts of two meshes at fixed poses.
#[derive(Clone, Debug)]
pub struct PairJob {
    /// First mesh.
    pub mesh1: MedialMesh,
    /// Second mesh.
    pub mesh2: MedialMesh,
    /// Pose of the second in the first's frame.
    pub pos12: Pose,
    /// How far apart spheres may be to count as a contact, a length.
    pub prediction: Real,
}

/// Answer to a [`PairJob`].
#[derive(Clone, Debug, Default)]
pub struct PairResult {
    /// The contacts: pairs of spheres within the prediction distance.
    pub contacts: Vec<SpherePair>,
    /// Whether the pair moves so little that these contacts may have to serve for several steps, but is not at rest.
    pub lasting: bool,
    /// The work it took.
    pub counts: Counts,
}

impl PairResult {
    fn new((contacts, counts): (Vec<SpherePair>, Counts)) -> Self {
        Self {
            contacts,
            lasting: false,
            counts,
        }
    }
}

impl PairJob {
    /// The contacts of two meshes, the second at `pos12` in the first's frame, within a prediction distance.
    pub fn of(meshes: [&MedialMesh; 2], pos12: &Pose, prediction: Real) -> Self {
        let [mesh1, mesh2] = meshes.map(MedialMesh::clone);
        Self {
            mesh1,
            mesh2,
            pos12: *pos12,
            prediction,
        }
    }
}

impl Job for PairJob {
    type Answer = PairResult;
    /// Contacts of two meshes take long enough for eight of them to pay.
    const PER_THREAD: usize = 8;
    fn answer(&self) -> PairResult {
        let (mesh1, mesh2) = (&self.mesh1, &self.mesh2);
        PairResult::new(crate::pair::contacts(
            mesh1,
            mesh2,
            &self.pos12,
            self.prediction,
        ))
    }
    fn sweep(&self) -> Option<Sweep<'_>> {
        Some(Sweep {
            meshes: [&self.mesh1, &self.mesh2],
            motions: [Pose::IDENTITY, self.pos12].map(NonlinearRigidMotion::constant_position),
            seconds: 0.0,
            reach: self.prediction.into(),
            lists: true,
        })
    }
    fn free(&self) -> PairResult {
        PairResult::default()
    }
    fn answer_near(&self, near: &[[u32; 2]]) -> PairResult {
        let (mesh1, mesh2) = (&self.mesh1, &self.mesh2);
        PairResult::new(crate::pair::contacts_of_listed(
            mesh1,
            mesh2,
            &self.pos12,
            self.prediction,
            &mut near.to_vec(),
        ))
    }
}

/// Asks for the first contact of two meshes that move rigidly.
#[derive(Clone, Debug)]
pub struct ToiJob {
    /// First mesh.
    pub mesh1: MedialMesh,
    /// Motion of the first mesh, in world space, with velocities per second.
    pub motion1: NonlinearRigidMotion,
    /// Second mesh.
    pub mesh2: MedialMesh,
    /// Motion of the second mesh, in world space, with velocities per second.
    pub motion2: NonlinearRigidMotion,
    /// Length of the step in seconds.
    pub seconds: Real,
    /// The distance that counts as a contact, and the tolerance of the answer.
    pub options: ToiOptions,
}

impl Job for ToiJob {
    type Answer = ToiResult;
    /// A query takes from below a microsecond to some hundreds; small groups spread the long ones.
    const PER_THREAD: usize = 4;
    fn answer(&self) -> ToiResult {
        let motions = [&self.motion1, &self.motion2];
        let bodies = (&self.mesh1, &self.mesh2);
        Query::new(motions, bodies, self.seconds, &self.options, None).settle()
    }
    fn sweep(&self) -> Option<Sweep<'_>> {
        let options = &self.options;
        // Under a lower cap a miss may stay unresolved; devices know rigid motions only.
        let sure = options.max_iterations >= MAX_ITERATIONS
            && options.time_tolerance.is_finite()
            && options.paths == Paths::Exact;
        let target = match options.initial_contact {
            InitialContact::Stop => options.target_distance.max(0.0),
            InitialContact::Deepen { .. } | InitialContact::Approach { .. } => {
                options.target_distance
            }
        };
        let finite = options.target_distance.is_finite();
        (sure && finite).then(|| Sweep {
            meshes: [&self.mesh1, &self.mesh2],
            motions: [self.motion1, self.motion2],
            seconds: self.seconds,
            reach: f64::from(target) + f64::from(options.tolerance),
            // The bits of a bracket depend on where a search begins it, and the search is short without a list.
            lists: false,
        })
    }
    fn free(&self) -> ToiResult {
        let toi = Toi::separated(&self.options);
        ToiResult::of(toi, Counts::default(), f64::INFINITY)
    }
}
