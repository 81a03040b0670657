//! Reads and writes `.ma` files, the text format for medial meshes of the program Q-MAT (Li et al. 2015).
//!
//! ```text
//! nV nE nF              header: counts
//! v x y z r             a sphere: centre and radius
//! e i j                 an edge between spheres, counted from 0
//! f i j k               a face
//! ```
//! Writers differ, so a reader accepts: edges of faces listed or not, further tokens on a line
//! (types and flags), CRLF, blank lines, `#` comments, any order of the elements.

use super::files::{self, file_error};
use super::mesh::MedialMesh;
use super::sphere::MedialSphere;
use super::text::{Line, Lines, TextError, quote};
use crate::error::MeshError;
use crate::math::Vector;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Write};
use std::path::Path;

/// Elements reserved ahead of reading at most (a count): a header may announce billions.
const RESERVE: usize = 1 << 16;

impl MedialMesh {
    /// Reads a `.ma` file, the text format of the program Q-MAT. Lengths stay in the file's unit. The file
    /// holds no mass properties, so those of the solid are used.
    ///
    /// # Errors
    /// [`MeshError::File`] if the file cannot be read, [`MeshError::Syntax`] with the line number if it ends
    /// early or breaks the format, and the errors of [`MedialMesh::new`].
    pub fn load_ma(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|source| file_error(path, source))?;
        Self::read_ma(BufReader::new(file), path)
    }

    /// Reads the text of a `.ma` file from a reader; errors call it `name`.
    ///
    /// # Errors
    /// The same as of [`MedialMesh::load_ma`].
    ///
    /// ```
    /// use rapier3d_medial::MedialMesh;
    /// let text = "2 1 0\nv 0 0 0 1\nv 3 0 0 0.5\ne 0 1\n";
    /// let taper = MedialMesh::read_ma(text.as_bytes(), "taper.ma".as_ref())?;
    /// assert_eq!(taper.edges(), [[0, 1]]);
    /// # Ok::<(), rapier3d_medial::MeshError>(())
    /// ```
    pub fn read_ma(reader: impl BufRead, name: &Path) -> Result<Self, MeshError> {
        let elements = Elements::read(reader).map_err(|error| match error {
            TextError::Io(source) => file_error(name, source),
            TextError::Syntax { line, message } => MeshError::Syntax {
                path: name.to_owned(),
                line,
                message,
            },
        })?;
        Self::new(elements.spheres, elements.edges, elements.faces)
    }

    /// Writes a `.ma` file, from which [`MedialMesh::load_ma`] reads exactly the same spheres, edges and faces.
    /// It does not hold mass properties; [`MedialMesh::save_asset`] does.
    ///
    /// # Errors
    /// [`MeshError::File`] if the file cannot be written. An older file at `path` is then still there, unchanged.
    pub fn save_ma(&self, path: impl AsRef<Path>) -> Result<(), MeshError> {
        files::replace(path.as_ref(), |file| self.write_ma(file))
    }

    /// Writes the text of a `.ma` file to a writer. Numbers have as few digits as give the same `f32` when read.
    ///
    /// # Errors
    /// Any error of the writer.
    pub fn write_ma(&self, writer: impl Write) -> io::Result<()> {
        let mut out = BufWriter::new(writer);
        let (spheres, edges, faces) = (self.spheres(), self.edges(), self.faces());
        writeln!(out, "{} {} {}", spheres.len(), edges.len(), faces.len())?;
        for MedialSphere { center, radius } in spheres {
            writeln!(out, "v {} {} {} {radius}", center.x, center.y, center.z)?;
        }
        for [a, b] in edges {
            writeln!(out, "e {a} {b}")?;
        }
        for [a, b, c] in faces {
            writeln!(out, "f {a} {b} {c}")?;
        }
        out.flush()
    }
}

/// Elements that a file lists.
struct Elements {
    spheres: Vec<MedialSphere>,
    edges: Vec<[u32; 2]>,
    faces: Vec<[u32; 3]>,
}

impl Elements {
    fn read(reader: impl BufRead) -> Result<Self, TextError> {
        let mut lines = Lines::new(reader);
        let Some(header) = lines.next_line()? else {
            return Err(TextError::Syntax {
                line: 1,
                message: "the file is empty, expected the counts `nV nE nF`".into(),
            });
        };
        let mut tokens = header.text.split_whitespace();
        let mut announced = [0usize; 3];
        for (count, what) in announced.iter_mut().zip(NAMES) {
            let given: u32 = header.parse(&mut tokens, &format!("the number of {what}"))?;
            *count = given as usize;
        }
        let [spheres, edges, faces] = announced.map(|count| count.min(RESERVE));
        let mut elements = Self {
            spheres: Vec::with_capacity(spheres),
            edges: Vec::with_capacity(edges),
            faces: Vec::with_capacity(faces),
        };
        while let Some(line) = lines.next_line()? {
            elements.add(&line, announced)?;
        }
        for ((found, announced), what) in elements.counts().into_iter().zip(announced).zip(NAMES) {
            if found < announced {
                return Err(TextError::Syntax {
                    line: lines.number(),
                    message: format!("the file ends after {found} of {announced} {what}"),
                });
            }
        }
        Ok(elements)
    }

    fn counts(&self) -> [usize; 3] {
        [self.spheres.len(), self.edges.len(), self.faces.len()]
    }

    fn add(&mut self, line: &Line, announced: [usize; 3]) -> Result<(), TextError> {
        let mut tokens = line.text.split_whitespace();
        let kind = match tokens.next() {
            Some("v") => 0,
            Some("e") => 1,
            Some("f") => 2,
            _ => {
                let found = quote(line.text);
                return Err(line.error(format!("expected `v`, `e` or `f`, found {found}")));
            }
        };
        if self.counts()[kind] == announced[kind] {
            let (count, what) = (announced[kind], NAMES[kind]);
            return Err(line.error(format!("more than the {count} {what} announced")));
        }
        match kind {
            0 => {
                let mut coordinate = |what| line.finite(&mut tokens, what);
                let center = Vector::new(coordinate("x")?, coordinate("y")?, coordinate("z")?);
                let radius = coordinate("the radius")?;
                if radius < 0.0 {
                    let text = quote(line.text);
                    return Err(line.error(format!("radius {radius} is negative in {text}")));
                }
                self.spheres.push(MedialSphere { center, radius });
            }
            1 => self.edges.push(indices(line, &mut tokens, announced[0])?),
            _ => self.faces.push(indices(line, &mut tokens, announced[0])?),
        }
        Ok(())
    }
}

/// Names of what the three counts of the header count.
const NAMES: [&str; 3] = ["spheres", "edges", "faces"];

fn indices<'t, const N: usize>(
    line: &Line,
    tokens: &mut impl Iterator<Item = &'t str>,
    count: usize,
) -> Result<[u32; N], TextError> {
    let mut found = [0; N];
    for k in 0..N {
        let index: u32 = line.parse(tokens, "a sphere's index")?;
        let problem = if index as usize >= count {
            format!("sphere {index} is not among the {count} announced")
        } else if found[..k].contains(&index) {
            format!("sphere {index} is named twice")
        } else {
            found[k] = index;
            continue;
        };
        return Err(line.error(format!("{problem} in {}", quote(line.text))));
    }
    Ok(found)
}
