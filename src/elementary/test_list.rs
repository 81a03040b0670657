//! Lists the elementary tests of two primitives (paper §4.1): cone against cone for each edge of one with each edge
//! of the other, and sphere against slab for each sphere with the other primitive's slab. As long
//! as their medial surfaces do not cross, the primitives touch exactly when the spheres of one of these tests do.
//!
//! A lone sphere is an edge of length zero; against a slab its one sphere–slab test covers the
//! slab's edges too.

/// Domain of the parameters of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Cone–cone: `α, β ∈ [0, 1]`.
    Box,
    /// Sphere–slab: `α, β ≥ 0`, `α + β ≤ 1`.
    Triangle,
}

/// One elementary test: for each corner of the domain the sphere of the first and of the second
/// primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ElementaryTest {
    /// Cone–cone or sphere–slab.
    pub domain: Domain,
    /// Corners in the order (0, 0), (1, 0), (0, 1), (1, 1); a triangle repeats its third.
    pub corners: [(u8, u8); 4],
}

impl ElementaryTest {
    /// Edge `a` of the first primitive against edge `b` of the second.
    pub fn cone_cone(a: [u8; 2], b: [u8; 2]) -> Self {
        Self {
            domain: Domain::Box,
            corners: [(a[0], b[0]), (a[1], b[0]), (a[0], b[1]), (a[1], b[1])],
        }
    }

    /// Slab of the first primitive against sphere `b` of the second.
    pub fn slab_sphere(b: u8) -> Self {
        Self {
            domain: Domain::Triangle,
            corners: [(0, b), (1, b), (2, b), (2, b)],
        }
    }

    /// Sphere `a` of the first primitive against the slab of the second.
    pub fn sphere_slab(a: u8) -> Self {
        Self {
            domain: Domain::Triangle,
            corners: [(a, 0), (a, 1), (a, 2), (a, 2)],
        }
    }
}

/// Edges of a primitive of `n` spheres: `bit` of its ownership mask and its two spheres.
pub fn edges(n: usize) -> &'static [[u8; 2]] {
    match n {
        1 => &[[0, 0]],
        2 => &[[0, 1]],
        _ => &[[0, 1], [1, 2], [2, 0]],
    }
}

/// Features that a primitive owns in the tests of a mesh: how many spheres it has, and which of its edges and spheres
/// it tests (bit `i` of each mask; all ones for a primitive on its own).
#[derive(Clone, Copy, Debug)]
pub struct OwnedFeatures {
    /// 1, 2 or 3.
    pub spheres: usize,
    /// Mask over [`edges`].
    pub edges: u8,
    /// Mask over the spheres.
    pub vertices: u8,
}

impl OwnedFeatures {
    /// All edges and spheres of a primitive on its own.
    pub fn whole(spheres: usize) -> Self {
        Self {
            spheres,
            edges: 0b111,
            vertices: 0b111,
        }
    }
}

/// Calls `visit` with every test that the two shares own; stops early when it returns `false`.
pub fn for_each_test(
    a: OwnedFeatures,
    b: OwnedFeatures,
    mut visit: impl FnMut(ElementaryTest) -> bool,
) {
    let owned = |mask: u8, i: usize| mask >> i & 1 == 1;
    let sphere_on_slab = (a.spheres == 1 && b.spheres == 3) || (a.spheres == 3 && b.spheres == 1);
    if !sphere_on_slab {
        for (i, ea) in edges(a.spheres).iter().enumerate() {
            for (j, eb) in edges(b.spheres).iter().enumerate() {
                if owned(a.edges, i)
                    && owned(b.edges, j)
                    && !visit(ElementaryTest::cone_cone(*ea, *eb))
                {
                    return;
                }
            }
        }
    }
    if a.spheres == 3 {
        for j in (0..b.spheres).filter(|&j| owned(b.vertices, j)) {
            if !visit(ElementaryTest::slab_sphere(j as u8)) {
                return;
            }
        }
    }
    if b.spheres == 3 {
        for i in (0..a.spheres).filter(|&i| owned(a.vertices, i)) {
            if !visit(ElementaryTest::sphere_slab(i as u8)) {
                return;
            }
        }
    }
}
