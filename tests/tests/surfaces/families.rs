//! Mesh families: properties of every mesh, and of each family.

use helfrich::Surface;
use helfrich::shapes::Shape;
use helfrich_std::generate::{
    AnyShape, Family, GenerateError, GeneratedMesh, ShapeDeviation, generate,
};
use helfrich_std::info::MeshInfo;
use helfrich_tests::meshes::{cross, difference, dot};
use helfrich_tests::tolerance::Tolerance;
use std::array::from_fn;

/// Distance of a mesh vertex from its shape, relative to the shape's size.
const ON_SURFACE: Tolerance = Tolerance::new(
    1e-13,
    "positions are images of their pre-images, and the inverse map rounds a few times",
);

const SHAPES: [&str; 8] = [
    "sphere",
    "ellipsoid",
    "ellipsoid:1,1,0.25",
    "torus",
    "torus:1,0.8",
    "torus:5e-6,1e-6",
    "discocyte",
    "discocyte:4e-6",
];

fn shape(name: &str) -> AnyShape {
    name.parse().unwrap()
}

fn make(name: &str, family: Family, vertices: usize, seed: u64) -> GeneratedMesh {
    generate(&shape(name), family, vertices, seed).unwrap()
}

fn is_torus(name: &str) -> bool {
    name.starts_with("torus")
}

fn corners(made: &GeneratedMesh) -> impl Iterator<Item = [[f64; 3]; 3]> {
    let triangles = made.mesh.triangles().iter();
    triangles.map(|triangle| triangle.map(|vertex| made.positions[vertex as usize]))
}

/// All angles of all triangles, in degrees, sorted.
fn angles(made: &GeneratedMesh) -> Vec<f64> {
    let of_triangle = |x: [[f64; 3]; 3]| -> [f64; 3] {
        from_fn(|i| {
            let next = difference(x[(i + 1) % 3], x[i]);
            let last = difference(x[(i + 2) % 3], x[i]);
            let across = cross(next, last);
            dot(across, across)
                .sqrt()
                .atan2(dot(next, last))
                .to_degrees()
        })
    };
    let mut angles = Vec::from_iter(corners(made).flat_map(of_triangle));
    angles.sort_by(f64::total_cmp);
    angles
}

fn valences(made: &GeneratedMesh) -> Vec<usize> {
    let vertices = 0..made.mesh.vertex_count();
    vertices.map(|vertex| made.mesh.valence(vertex)).collect()
}

/// Standard deviation of the edge lengths, relative to their mean.
fn unevenness(made: &GeneratedMesh) -> f64 {
    let lengths = Vec::from_iter(made.mesh.edges().iter().map(|edge| {
        let [a, b] = edge.map(|vertex| made.positions[vertex as usize]);
        dot(difference(a, b), difference(a, b)).sqrt()
    }));
    let count = lengths.len() as f64;
    let mean = lengths.iter().sum::<f64>() / count;
    let square = lengths.iter().map(|length| (length / mean - 1.0).powi(2));
    (square.sum::<f64>() / count).sqrt()
}

/// Smallest cosine of the angle between a triangle's normal and the exact one at its centre.
fn alignment(made: &GeneratedMesh) -> f64 {
    let of_triangle = |x: [[f64; 3]; 3]| {
        let centre = from_fn(|i| (x[0][i] + x[1][i] + x[2][i]) / 3.0);
        let normal = made.shape.at(made.shape.preimage(centre)).normal;
        let area = cross(difference(x[1], x[0]), difference(x[2], x[0]));
        dot(area, normal) / dot(area, area).sqrt()
    };
    corners(made).map(of_triangle).fold(1.0, f64::min)
}

#[test]
fn every_mesh_is_closed_oriented_and_on_its_shape() {
    for name in SHAPES {
        for family in Family::ALL {
            for vertices in [642, 2562] {
                let what = format!("{family} mesh of {vertices} on {name}");
                let made = make(name, family, vertices, 3);
                assert!(made.mesh.is_closed(), "{what}");
                let euler = if is_torus(name) { 0 } else { 2 };
                assert_eq!(made.mesh.euler_characteristic(), euler, "{what}");
                assert_eq!(made.mesh.components().1, 1, "{what}");

                let count = made.mesh.vertex_count();
                assert_eq!([made.positions.len(), made.preimages.len()], [count; 2]);
                if is_torus(name) && family != Family::Irregular {
                    assert!(count.abs_diff(vertices) * 100 < vertices, "{what}: {count}");
                } else {
                    assert_eq!(count, vertices, "{what}");
                }

                assert!(alignment(&made) > 0.05, "{what}: {}", alignment(&made));
                for (&preimage, &position) in made.preimages.iter().zip(&made.positions) {
                    assert_eq!(position, made.shape.position(preimage), "{what}");
                    let again = made.shape.position(made.shape.preimage(position));
                    let size = made.shape.size();
                    for i in 0..3 {
                        ON_SURFACE.assert(again[i], position[i], size, &what);
                    }
                }
            }
        }
    }
}

#[test]
fn the_seed_decides() {
    let bits = |made: &GeneratedMesh| {
        let numbers = made.positions.iter().flatten();
        Vec::from_iter(numbers.map(|x| x.to_bits()))
    };
    for name in ["sphere", "torus", "discocyte"] {
        for family in Family::ALL {
            let [first, again, other] = [1, 1, 2].map(|seed| make(name, family, 642, seed));
            assert_eq!(bits(&first), bits(&again), "{family} on {name}");
            assert_eq!(first.mesh, again.mesh, "{family} on {name}");
            let random = matches!(family, Family::Irregular | Family::Hard);
            assert_eq!(bits(&first) != bits(&other), random, "{family} on {name}");
        }
    }
}

/// The digest of a mesh is the same on every machine, and changes with any bit. It changes only if a family
/// is changed on purpose.
#[test]
fn meshes_are_the_same_everywhere() {
    let digest = |name, family| {
        let made = make(name, family, 642, 7);
        let numbers = made.positions.iter().flatten().map(|x| x.to_bits());
        let corners = made
            .mesh
            .triangles()
            .iter()
            .flatten()
            .map(|&v| u64::from(v));
        let mix = |digest: u64, bits: u64| (digest ^ bits).wrapping_mul(0x0100_0000_01b3);
        numbers.chain(corners).fold(0xcbf2_9ce4_8422_2325, mix)
    };
    let found = ["torus", "discocyte"].map(|name| Family::ALL.map(|family| digest(name, family)));
    let expected = [
        [
            0xa25b_84dd_4761_7c7f,
            0xa25b_84dd_4761_7c7f,
            0x2d05_9678_1c55_9f3e,
            0x3bbc_f0b4_60cd_1773,
            0xd4ee_4edb_471a_2bb0,
        ],
        [
            0xa111_ac5e_bb2f_d61f,
            0xda49_5181_77d4_48e5,
            0xffd5_c574_9999_7f21,
            0x198d_87f0_2d13_7347,
            0x8e2c_782f_6ea4_bba8,
        ],
    ];
    assert_eq!(found, expected, "{found:#018x?}");
}

#[test]
fn regular_and_relaxed_meshes_are_even() {
    for name in SHAPES {
        for vertices in [642, 2562] {
            let [regular, relaxed] =
                [Family::Regular, Family::Relaxed].map(|family| make(name, family, vertices, 0));
            let flipped = !is_torus(name) && regular.mesh != relaxed.mesh;
            assert!(
                !flipped,
                "{name}: relaxing must not change the connectivity"
            );
            if !is_torus(name) {
                let [before, after] = [&regular, &relaxed].map(unevenness);
                assert!(after < 0.9 * before, "{name}: {before} to {after}");
            }
            let [before, after] = [&regular, &relaxed].map(|made| angles(made)[0]);
            assert!(after > 0.98 * before, "{name}: {before}° to {after}°");
            for made in [&regular, &relaxed] {
                let range = if is_torus(name) { 6..=6 } else { 5..=6 };
                assert!(valences(made).iter().all(|valence| range.contains(valence)));
            }
            // These two shapes stretch their pre-images more than the others.
            let least = match name {
                "ellipsoid:1,1,0.25" | "torus:1,0.8" => 10.0,
                _ => 30.0,
            };
            assert!(before > least, "{name}: {before}°");
        }
    }
}

/// Area and volume of meshes on prolates and oblates agree with the exact ones in every family.
///
/// Inscribed meshes have less of both; even meshes of the sphere lack 3h²/8 = √3 π/N = 0.2 % of the volume,
/// and the limits are two and four times that, rounded.
#[test]
fn meshes_carry_the_area_and_volume_of_long_and_flat_shapes() {
    for aspect in [1.5, 2.5, 3.5, 5.0, 7.0, 10.0] {
        let limit = if aspect > 5.0 { 0.01 } else { 0.005 };
        for name in [
            format!("ellipsoid:1,1,{aspect}"),
            format!("ellipsoid:{aspect},{aspect},1"),
            format!("ellipsoid:2,2.4,{}", 2.2 * aspect),
        ] {
            for family in Family::ALL {
                let made = make(&name, family, 2562, 1);
                let surface = Surface::new(&made.mesh, &made.positions).unwrap();
                let info = MeshInfo::new(surface);
                let deviation = ShapeDeviation::new(&made.shape, 1.0, &info);
                for (value, what) in [(deviation.area, "area"), (deviation.volume, "volume")] {
                    assert!(
                        -limit < value && value < 0.0,
                        "{family} on {name}: {:.3} % of {what}",
                        100.0 * value
                    );
                }
                assert!(!deviation.is_beyond_limit(), "{family} on {name}");
            }
        }
    }
}

/// Areas agree with closed forms for two equal semi-axes, and for the other shapes with areas of inscribed
/// meshes, extrapolated to remove their second-order error.
#[test]
fn areas_of_shapes() {
    let pi = std::f64::consts::PI;
    let close = |name: &str, expected: f64, tolerance: f64| {
        let found = shape(name).area();
        assert!(
            (found / expected - 1.0).abs() < tolerance,
            "{name}: {found} for {expected}"
        );
    };
    close("sphere:3", 36.0 * pi, 1e-15);
    close("ellipsoid:3e-90,3e-90,3e-90", 36e-180 * pi, 1e-14);
    for aspect in [1.1f64, 2.0, 10.0, 1000.0] {
        let eccentricity = (1.0 - aspect.powi(-2)).sqrt();
        let prolate = 2.0 * pi * (1.0 + aspect / eccentricity * eccentricity.asin());
        close(&format!("ellipsoid:1,{aspect},1"), prolate, 1e-12);
        let square = aspect * aspect;
        let oblate = 2.0 * pi * (square + eccentricity.atanh() / eccentricity);
        close(&format!("ellipsoid:{aspect},{aspect},1"), oblate, 1e-12);
    }
    for name in ["ellipsoid:1,2,3", "torus", "discocyte:2"] {
        let [coarse, fine] = [2562, 10242].map(|vertices| {
            let made = make(name, Family::Smooth, vertices, 0);
            Surface::new(&made.mesh, &made.positions).unwrap().area()
        });
        close(name, (4.0 * fine - coarse) / 3.0, 1e-5);
    }
}

/// Largest distance of a vertex on the unit sphere from the mean of its six neighbours, in mean edges
/// squared; a smooth parametrisation leaves a distance of second order along the surface.
fn largest_kink(made: &GeneratedMesh) -> f64 {
    let count = made.positions.len() as f64;
    let edge_squared = 4.0 * std::f64::consts::PI / count * 2.0 / 3f64.sqrt();
    let kink = |vertex: usize| {
        let here = made.positions[vertex];
        let ring = made.mesh.one_ring(vertex);
        let sum = |axis| {
            ring.iter()
                .map(|&v| made.positions[v as usize][axis] - here[axis])
                .sum()
        };
        let mean: [f64; 3] = from_fn(|axis: usize| -> f64 { sum(axis) }).map(|sum| sum / 6.0);
        let along: [f64; 3] = from_fn(|axis| mean[axis] - dot(mean, here) * here[axis]);
        dot(along, along).sqrt() / edge_squared
    };
    let regular = (0..made.positions.len()).filter(|&vertex| made.mesh.valence(vertex) == 6);
    regular.map(kink).fold(0.0, f64::max)
}

/// Midpoint refinement leaves kinks along the icosahedron's edges, which grow like 1/h relative to a smooth
/// parametrisation. Loop subdivision leaves smaller ones, only next to extraordinary vertices.
#[test]
fn smooth_meshes_have_no_kinks() {
    for vertices in [642, 2562, 10242] {
        let [regular, smooth] =
            [Family::Regular, Family::Smooth].map(|family| make("sphere", family, vertices, 0));
        assert_eq!(regular.mesh.vertex_count(), smooth.mesh.vertex_count());
        let [midpoints, limit] = [&regular, &smooth].map(largest_kink);
        assert!(
            6.0 * limit < midpoints,
            "{vertices}: {midpoints} and {limit}"
        );
        let [five, six] = [5, 6].map(|n| valences(&smooth).iter().filter(|&&v| v == n).count());
        assert_eq!([five, six], [12, vertices - 12]);
        assert!(angles(&smooth)[0] > 45.0);
    }
    for torus in ["torus", "torus:1,0.8"] {
        let [regular, smooth] =
            [Family::Regular, Family::Smooth].map(|family| make(torus, family, 642, 0));
        assert_eq!(regular.positions, smooth.positions);
        assert_eq!(regular.mesh, smooth.mesh);
    }
}

#[test]
fn irregular_meshes_are_irregular_and_well_spaced() {
    for name in SHAPES {
        for (seed, numbers) in [(1, &[2562, 10242][..]), (2, &[2562])] {
            for &vertices in numbers {
                let made = make(name, Family::Irregular, vertices, seed);
                let valences = valences(&made);
                let fewest = *valences.iter().min().unwrap();
                let most = *valences.iter().max().unwrap();
                let smallest = angles(&made)[0];
                let what = format!("{name}, {vertices}: valence {fewest} to {most}, {smallest}°");
                assert!(
                    (3..=4).contains(&fewest) && (9..=14).contains(&most),
                    "{what}"
                );
                assert!((2.0..12.0).contains(&smallest), "{what}");
                let small = angles(&made).iter().filter(|&&angle| angle < 12.0).count();
                assert!(small * 10 < vertices, "{what}, {small} below 12°");
                assert!(
                    unevenness(&made) < 0.5,
                    "{what}, edges {}",
                    unevenness(&made)
                );
            }
        }
    }
}

#[test]
fn hard_meshes_have_needles_and_caps() {
    for name in SHAPES {
        for vertices in [2562, 10242] {
            let made = make(name, Family::Hard, vertices, 1);
            let angles = angles(&made);
            let [smallest, largest] = [angles[0], angles[angles.len() - 1]];
            let what = format!("{name}, {vertices}: {smallest}° to {largest}°");
            assert!((0.69..0.8).contains(&smallest), "{what}");
            assert!((174.0..176.01).contains(&largest), "{what}");
            // A needle has two triangles with one tiny angle each, a cap has one triangle with an angle near
            // 180°.
            let needles = angles.iter().filter(|&&angle| angle < 1.7).count() / 2;
            let caps = angles.iter().filter(|&&angle| angle > 165.0).count();
            assert!(100 * needles > vertices / 2, "{what}: {needles} needles");
            assert!(100 * caps > vertices / 2, "{what}: {caps} caps");
        }
    }
}

/// Numbers of vertices to which no icosahedron can be refined. Besides a dozen vertices of valence 5 there
/// are pairs of valences 5 and 7, which up to three cut edges leave in each refinement: near them, angles may
/// be 0.4 of the smallest of an icosphere, and edge lengths vary three times as much.
#[test]
fn any_number_of_vertices() {
    for name in SHAPES.into_iter().filter(|name| !is_torus(name)) {
        for family in [
            Family::Regular,
            Family::Smooth,
            Family::Relaxed,
            Family::Hard,
        ] {
            for vertices in [100, 161, 163, 643, 3000] {
                let what = format!("{family} mesh of {vertices} on {name}");
                let made = make(name, family, vertices, 3);
                assert_eq!(made.mesh.vertex_count(), vertices, "{what}");
                assert!(made.mesh.is_closed(), "{what}");
                assert_eq!(made.mesh.euler_characteristic(), 2, "{what}");
                let least = alignment(&made);
                assert!(least > 0.05, "{what}: {least}");
                let extraordinary = valences(&made).iter().filter(|&&v| v != 6).count();
                assert!(extraordinary <= 48, "{what}: {extraordinary}");
                assert!(
                    valences(&made).iter().all(|v| (4..=8).contains(v)),
                    "{what}"
                );
            }
        }
        for family in [Family::Smooth, Family::Relaxed] {
            let refined = make(name, family, 2562, 0);
            for vertices in [1000, 3000] {
                let other = make(name, family, vertices, 0);
                let what = format!("{family} mesh of {vertices} on {name}");
                let [own, icosahedral] = [&other, &refined].map(unevenness);
                assert!(own < 3.0 * icosahedral, "{what}: {own} and {icosahedral}");
                let [own, icosahedral] = [&other, &refined].map(|made| angles(made)[0]);
                assert!(own > 0.4 * icosahedral, "{what}: {own}° and {icosahedral}°");
            }
        }
    }
}

/// The smallest meshes are valid, or refused with a reason.
#[test]
fn coarse_meshes() {
    for name in SHAPES {
        for family in Family::ALL {
            for vertices in [12, 16, 42, 100, 162] {
                match generate(&shape(name), family, vertices, 1) {
                    Ok(made) => assert!(made.mesh.is_closed()),
                    Err(error) => {
                        let expected = matches!(
                            error,
                            GenerateError::OutOfRange { .. } | GenerateError::TooCoarse { .. }
                        );
                        assert!(expected, "{family} mesh of {vertices} on {name}: {error}");
                    }
                }
            }
        }
    }
}

#[test]
fn impossible_requests_are_explained() {
    let message = |name, family, vertices| {
        let error = generate(&shape(name), family, vertices, 0).unwrap_err();
        error.to_string()
    };
    assert_eq!(
        message("discocyte", Family::Regular, 11),
        "11 vertices on the discocyte are out of range: between 12 and 357913937 are needed"
    );
    assert_eq!(
        message("sphere", Family::Irregular, 3),
        "3 vertices on the sphere are out of range: between 12 and 357913937 are needed"
    );
    assert!(message("torus", Family::Hard, usize::MAX).contains("out of range"));
    assert!(message("sphere", Family::Hard, usize::MAX).contains("out of range"));
}

#[test]
fn names() {
    for name in SHAPES {
        assert_eq!(shape(&shape(name).to_string()), shape(name));
    }
    assert_eq!(shape("ellipsoid").to_string(), "ellipsoid:1,0.8,0.6");
    assert_eq!(shape("torus: 3, 1").to_string(), "torus:3,1");
    for family in Family::ALL {
        assert_eq!(family.name().parse(), Ok(family));
    }

    let message = |text: &str| text.parse::<AnyShape>().unwrap_err().to_string();
    assert_eq!(
        ["cube", "torus:1", "sphere:big", "torus:1,2", "sphere:-1"].map(message),
        [
            "there is no shape `cube`: choose sphere, ellipsoid, torus or discocyte",
            "1 parameters are given where 2 are needed, as in torus:2,1",
            "`big` is not a number: parameters are written as in sphere:1",
            "the torus's tube radius is 2: it must lie above 0 and below 1",
            "the sphere's radius is -1: it must lie above 0 and below inf",
        ]
    );
    let error = "smooht".parse::<Family>().unwrap_err().to_string();
    assert!(error.contains("`smooht`"), "{error}");
}
