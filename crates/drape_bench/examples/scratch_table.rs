//! scratch
use drape_bench::bombardment::*;
use drape_solver::{BallMaterial,SolverSettings};
use drape_solver::glam::Vec3;
fn main(){
    let a:Vec<u32>=std::env::args().skip(1).map(|s|s.parse().unwrap()).collect();
    let plan=[(0.0f32, 1.5f32, 15.0f32), (-1.0, 1.2, 18.0), (0.9, 1.8, 12.0), (0.3, 1.3, 25.0), (-0.5, 1.0, 21.0)];
    let muzzle=Vec3::new(0.,1.,12.);
    let shots=plan.iter().enumerate().map(|(i,&(x,y,v))|{
        let to=drape_solver::glam::DVec3::new(x as f64,y as f64,0.)-muzzle.as_dvec3();
        let d=(to.x*to.x+to.z*to.z).sqrt();
        let e=drape_solver::ballistics::elevation_for(d,to.y,v as f64,9.81).unwrap();
        let az=f64::atan2(-to.x,-to.z);
        let dir=drape_solver::ballistics::direction(e,az);
        Shot{time:1.0+3.0*i as f64,muzzle,velocity:(dir*v as f64).as_vec3()}
    }).collect();
    let b=Bombardment{size:[4.,3.],clearance:0.3,particles:[a[0],a[1]],settings:SolverSettings{substeps:16,iterations:2,drag:2.0,..Default::default()},
      ball:BallMaterial{rolling_resistance:0.1,..Default::default()},shots,step:1.0/60.0,gravity:Vec3::new(0.,-9.81,0.),rest:3.0};
    let t=std::time::Instant::now();
    let r=drape_bench::table1::measure(&b,|_|{}).unwrap();
    println!("{}\n{:?}",r.table(),t.elapsed());
}
