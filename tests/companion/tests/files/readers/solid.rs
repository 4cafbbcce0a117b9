//! Closed meshes, written by hand in every format.

use std::fmt::Write;

/// A closed mesh as plain lists.
pub(super) struct Solid {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Tetrahedron whose coordinates need all digits of an `f64`.
pub(super) fn tetrahedron() -> Solid {
    Solid {
        positions: vec![
            [0.1, 0.2, 0.3],
            [1.0 + f64::EPSILON, 0.0, -1e-300],
            [0.0, 1.0 / 3.0, 0.0],
            [0.0, 0.0, 12_345.678_901_234_5],
        ],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    }
}

pub(super) fn icosahedron() -> Solid {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions = Vec::new();
    for [a, b] in [
        [1.0, golden],
        [1.0, -golden],
        [-1.0, golden],
        [-1.0, -golden],
    ] {
        positions.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
    }
    // The faces are the triples whose edges all have length 2, oriented outwards.
    let mut triangles = Vec::new();
    let distance = |i: usize, j: usize| {
        let squares = (0..3).map(|k| (positions[i][k] - positions[j][k]).powi(2));
        squares.sum::<f64>().sqrt()
    };
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let lengths = [distance(i, j), distance(j, k), distance(k, i)];
                if lengths.iter().all(|length| (length - 2.0).abs() < 1e-9) {
                    let [a, b, c] = [positions[i], positions[j], positions[k]];
                    let determinant = a[0] * (b[1] * c[2] - b[2] * c[1])
                        + a[1] * (b[2] * c[0] - b[0] * c[2])
                        + a[2] * (b[0] * c[1] - b[1] * c[0]);
                    let [i, j, k] = [i as u32, j as u32, k as u32];
                    triangles.push(if determinant > 0.0 {
                        [i, j, k]
                    } else {
                        [i, k, j]
                    });
                }
            }
        }
    }
    Solid {
        positions,
        triangles,
    }
}

impl Solid {
    pub(super) fn obj(&self) -> String {
        let mut text = "# a comment\no solid\n".to_owned();
        for [x, y, z] in &self.positions {
            writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
        }
        for [a, b, c] in &self.triangles {
            writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
        }
        text
    }

    pub(super) fn off(&self) -> String {
        let mut text = format!("OFF\n{} {} 0\n", self.positions.len(), self.triangles.len());
        for [x, y, z] in &self.positions {
            writeln!(text, "{x:?} {y:?} {z:?}").unwrap();
        }
        for [a, b, c] in &self.triangles {
            writeln!(text, "3 {a} {b} {c}").unwrap();
        }
        text
    }

    pub(super) fn stl(&self) -> String {
        let mut text = "solid a name\n".to_owned();
        for triangle in &self.triangles {
            text += "facet normal 0 0 0\n  outer loop\n";
            for &vertex in triangle {
                let [x, y, z] = self.positions[vertex as usize];
                writeln!(text, "    vertex {x:?} {y:?} {z:?}").unwrap();
            }
            text += "  endloop\nendfacet\n";
        }
        text + "endsolid a name\n"
    }

    pub(super) fn binary_stl(&self) -> Vec<u8> {
        let mut bytes = b"solid, although binary".to_vec();
        bytes.resize(80, b' ');
        bytes.extend((self.triangles.len() as u32).to_le_bytes());
        for triangle in &self.triangles {
            bytes.extend([0; 12]);
            for &vertex in triangle {
                for coordinate in self.positions[vertex as usize] {
                    bytes.extend((coordinate as f32).to_le_bytes());
                }
            }
            bytes.extend([0; 2]);
        }
        bytes
    }

    pub(super) fn ply_header(&self, encoding: &str) -> String {
        format!(
            "ply\nformat {encoding} 1.0\ncomment C:\\dir\\\n\
             element vertex {}\nproperty uchar red\nproperty double z\nproperty double x\n\
             property list uchar short weights\nproperty double y\n\
             element material 1\nproperty int shininess\n\
             element face {}\nproperty list uchar int vertex_indices\nproperty float quality\n\
             end_header\n",
            self.positions.len(),
            self.triangles.len()
        )
    }

    pub(super) fn ply(&self) -> String {
        let mut text = self.ply_header("ascii");
        for [x, y, z] in &self.positions {
            writeln!(text, "255 {z:?} {x:?} 2 7 8 {y:?}").unwrap();
        }
        text += "90\n";
        for [a, b, c] in &self.triangles {
            writeln!(text, "3 {a} {b} {c} 0.5").unwrap();
        }
        text
    }

    pub(super) fn binary_ply(&self, big: bool) -> Vec<u8> {
        let encoding = if big {
            "binary_big_endian"
        } else {
            "binary_little_endian"
        };
        let mut bytes = self.ply_header(encoding).into_bytes();
        let mut put = |number: &[u8]| {
            if big {
                bytes.extend(number.iter().rev());
            } else {
                bytes.extend(number);
            }
        };
        for [x, y, z] in &self.positions {
            put(&[255]);
            put(&z.to_le_bytes());
            put(&x.to_le_bytes());
            put(&[2]);
            put(&7i16.to_le_bytes());
            put(&8i16.to_le_bytes());
            put(&y.to_le_bytes());
        }
        put(&90i32.to_le_bytes());
        for triangle in &self.triangles {
            put(&[3]);
            for vertex in triangle {
                put(&vertex.to_le_bytes());
            }
            put(&0.5f32.to_le_bytes());
        }
        bytes
    }
}

/// `solid` with vertices numbered by their first appearance in triangles, as by STL readers.
pub(super) fn in_order_of_appearance(solid: &Solid, round: impl Fn(f64) -> f64) -> Solid {
    let mut order = Vec::new();
    for vertex in solid.triangles.iter().flatten() {
        if !order.contains(vertex) {
            order.push(*vertex);
        }
    }
    let number = |vertex| order.iter().position(|&v| v == vertex).unwrap() as u32;
    Solid {
        positions: order
            .iter()
            .map(|&vertex| solid.positions[vertex as usize].map(&round))
            .collect(),
        triangles: solid.triangles.iter().map(|t| t.map(number)).collect(),
    }
}
