//! Parameters of effects that are not finite are refused and named.

use helfrich::{
    AnyFunctional, AreaDifference, Aspiration, EndPull, Gravity, MembraneViscosity, Method,
    OsmoticPressure, ParameterError, Penalty, PointLoads, Repulsion, SurfaceTension, Targets,
    WallAdhesion,
};
use helfrich::{Images, Interaction, Prepared, Serial};
use helfrich_tests::meshes::icosphere;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Checks that the method names the parameter and cannot be prepared.
fn refused(method: impl Method<f64>, parameter: &str) {
    let mesh = icosphere(1);
    match method.check() {
        Err(ParameterError::NotFinite { parameter: found }) => assert_eq!(found, parameter),
        other => panic!("{parameter}: {other:?}"),
    }
    let prepare = || drop(Prepared::new(method, &mesh.connectivity));
    let payload = catch_unwind(AssertUnwindSafe(prepare)).expect_err(parameter);
    let message = payload.downcast_ref::<String>().expect("a message");
    assert_eq!(*message, format!("the {parameter} is not a finite number"));
}

#[test]
fn parameters_that_are_no_numbers_are_refused() {
    let mesh = icosphere(1);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let place = [0.0, value, 0.0];
        let (weight, level) = ([0.0, 0.0, 1.0], [0.0; 3]);
        let heavy = Gravity {
            weight: place,
            level,
        };
        refused(heavy, "weight per volume");
        let deep = Gravity {
            weight,
            level: place,
        };
        refused(deep, "level of gravity");
        let pipette = Aspiration {
            pressure: 1.0,
            mouth: [0.0; 3],
            axis: [0.0, 0.0, 1.0],
            width: 0.1,
        };
        let (pressure, mouth, axis, width) = (value, place, place, value);
        let strong = Aspiration {
            pressure,
            ..pipette
        };
        refused(strong, "pressure of the aspiration");
        refused(Aspiration { mouth, ..pipette }, "mouth of the pipette");
        refused(Aspiration { axis, ..pipette }, "axis of the pipette");
        let wide = Aspiration { width, ..pipette };
        refused(wide, "width of the mouth's pressure");
        let sharp = Aspiration {
            width: 0.0,
            ..pipette
        };
        refused(sharp, "inverse width of the mouth's pressure");
        let slope = "tension, pressure difference or Gaussian modulus";
        refused(SurfaceTension::new(value), slope);
        refused(OsmoticPressure::new(value), slope);
        let modulus = "modulus of a penalty";
        refused(Penalty::new(AnyFunctional::Area, value, 1.0), modulus);
        let target = "target of a penalty";
        refused(Penalty::new(AnyFunctional::Area, 1.0, value), target);
        let targets = Targets::PerComponent(vec![1.0, value]);
        refused(Penalty::new(AnyFunctional::Area, 1.0, targets), target);
        let modulus = "modulus of the area difference";
        refused(AreaDifference::new(value, 1.0), modulus);
        refused(AreaDifference::new(1.0, value), "target of ∫ H dS");
        let wall = WallAdhesion {
            strength: 1.0,
            distance: 0.1,
            range: 0.2,
            wall: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
        };
        let far = WallAdhesion {
            wall: place,
            ..wall
        };
        refused(far, "point of the wall");
        let askew = WallAdhesion {
            normal: place,
            ..wall
        };
        refused(askew, "normal of the wall");
        let wide = WallAdhesion {
            range: value,
            ..wall
        };
        refused(wide, "range of the adhesion");
        let load = PointLoads::new(&mesh.connectivity, vec![(0, [1.0; 3])]).expect("a load");
        refused(load.with_level(place), "level of the loads");
        let depths = [1.0, value];
        let (axis, force, stiffness, length) = (place, value, value, value);
        let pull = EndPull {
            axis: [1.0, 0.0, 0.0],
            depths: [1.0; 2],
            force: 1.0,
            stiffness: 1.0,
            length: 1.0,
        };
        refused(EndPull { axis, ..pull }, "axis of the pull");
        refused(EndPull { depths, ..pull }, "depth of an end");
        refused(EndPull { force, ..pull }, "pulling force");
        refused(EndPull { stiffness, ..pull }, "stiffness of the pull");
        refused(EndPull { length, ..pull }, "length of the pull");
        let (shear, dilational) = (value, 1.0);
        let viscosity = MembraneViscosity { shear, dilational };
        refused(viscosity, "shear viscosity of the membrane");
        let (shear, dilational) = (1.0, value);
        let viscosity = MembraneViscosity { shear, dilational };
        refused(viscosity, "dilational viscosity of the membrane");
    }
}

/// A repulsion has no preparation in which to refuse its modulus: with a NaN modulus its energy is NaN.
#[test]
fn a_repulsion_without_modulus_has_no_energy() {
    let [near, other] = [0.0, 2.05].map(|shift| icosphere(2).map(|[x, y, z]| [x + shift, y, z]));
    for modulus in [f64::NAN, 1.0] {
        let repulsion = Repulsion {
            modulus,
            range: 0.2,
            attraction: 0.0,
            parts: false,
            first_group: None,
            images: Images::none(),
        };
        let surfaces = [near.surface(), other.surface()];
        let energy = repulsion.energy(&Serial, &surfaces, &mut Default::default());
        assert_eq!(energy.is_nan(), modulus.is_nan(), "{modulus}: {energy}");
    }
}
