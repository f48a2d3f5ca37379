!> One grain in a prescribed gas, and what the balance of its weight and its drag says of it.
module lone_grain
  use communicator, only: communicator_t
  use constants, only: pi
  use coupling_scene, only: scene_t, build, add, step, set_gas, gravity, viscosity, density
  use drag_law, only: drag_law_t, new_drag_law
  use kinds, only: wp
  use parcels, only: velocity_row
  implicit none
  private
  public :: balanced_slip, grain_velocity, settled_velocity, transient_error

contains

  !> The vertical velocity of the one parcel, on all ranks [m/s].
  function grain_velocity(scene) result(v)
    type(scene_t), intent(in) :: scene
    real(wp) :: v

    v = 0.0_wp
    if (scene%parcels%n > 0) v = scene%parcels%state(velocity_row + 1, 1)
    v = scene%boxes%comm%sum(v)
  end function grain_velocity

  !> The slip at which drag on a sphere alone carries its weight g rho_p V, by bisection [m/s].
  function balanced_slip(diameter, solid_density, drag) result(w)
    real(wp), intent(in) :: diameter, solid_density
    character(len=*), intent(in) :: drag
    real(wp) :: w

    type(drag_law_t) :: law
    real(wp) :: low, high, force, reynolds
    integer :: i

    law = new_drag_law(drag)
    low = 0.0_wp
    high = 100.0_wp
    do i = 1, 80
      w = (low + high)/2
      reynolds = density*w*diameter/viscosity
      force = 3*pi*viscosity*diameter*w*law%factor_at(reynolds, 1.0_wp)
      if (force < -gravity(2)*solid_density*pi/6*diameter**3) then
        low = w
      else
        high = w
      end if
    end do
  end function balanced_slip

  !> A parcel of 100 um and 2000 kg/m3 after 3 s in gas that rises at 0.3 m/s [m/s].
  function settled_velocity(comm, weight, drag) result(v)
    type(communicator_t), intent(in) :: comm
    real(wp), intent(in) :: weight        !< [-]
    character(len=*), intent(in) :: drag  !< name of the law
    real(wp) :: v

    type(scene_t) :: scene
    integer :: i

    call build(comm, 1.0e4_wp, [4, 8, 4], [.false., .false., .false.], drag, scene)
    call set_gas(scene, [0.0_wp, 0.3_wp, 0.0_wp], spread(0.0_wp, 1, 3))
    call add(scene, [3210.0_wp, 7700.0_wp, 5500.0_wp], [100.0_wp, -100.0_wp, 0.0_wp], 1.0e-4_wp, 2000.0_wp, weight)
    do i = 1, 30
      call step(scene, 0.1_wp)
    end do
    v = grain_velocity(scene)
  end function settled_velocity

  !> A 100 um grain of 2000 kg/m3 starts at rest in gas that rises at 0.4 m/s: the largest distance of its velocity in
  !> 0.35 s from an integration in small steps (Runge-Kutta of fourth order), buoyancy included, over its final speed.
  function transient_error(comm, dt) result(error)
    type(communicator_t), intent(in) :: comm
    real(wp), intent(in) :: dt  !< [s]
    real(wp) :: error

    real(wp), parameter :: d = 1.0e-4_wp, solid_density = 2000.0_wp
    type(scene_t) :: scene
    real(wp) :: exact
    integer :: i

    call build(comm, 1.0e4_wp, [4, 8, 4], [.false., .false., .false.], 'gidaspow', scene)
    call set_gas(scene, [0.0_wp, 0.4_wp, 0.0_wp], density*gravity)
    call add(scene, [3210.0_wp, 7700.0_wp, 5500.0_wp], spread(0.0_wp, 1, 3), d, solid_density, 1.0_wp)
    exact = 0.0_wp
    error = 0.0_wp
    do i = 1, nint(0.35_wp/dt)
      call step(scene, dt)
      exact = runge_kutta(exact, dt, 20, 0.4_wp, d, solid_density)
      error = max(error, abs(grain_velocity(scene) - exact))
    end do
    error = error/abs(exact)
  end function transient_error

  !> dv/dt = g (1 - rho/rho_p) + beta (u - v)/m over dt in n steps, Schiller-Naumann drag.
  pure function runge_kutta(start, dt, n, u, d, solid_density) result(v)
    real(wp), intent(in) :: start, dt, u, d, solid_density  !< [m/s], [s], [m/s], [m], [kg/m3]
    integer, intent(in) :: n
    real(wp) :: v

    real(wp) :: k(4), h
    integer :: i

    v = start
    h = dt/n
    do i = 1, n
      k(1) = slope(v, u, d, solid_density)
      k(2) = slope(v + h/2*k(1), u, d, solid_density)
      k(3) = slope(v + h/2*k(2), u, d, solid_density)
      k(4) = slope(v + h*k(3), u, d, solid_density)
      v = v + h/6*(k(1) + 2*k(2) + 2*k(3) + k(4))
    end do
  end function runge_kutta

  pure function slope(v, u, d, solid_density)
    real(wp), intent(in) :: v, u, d, solid_density
    real(wp) :: slope

    slope = gravity(2)*(1 - density/solid_density) + 18*viscosity/(solid_density*d**2)*(u - v) &
      *(1 + 0.15_wp*(density*abs(u - v)*d/viscosity)**0.687_wp)
  end function slope

end module lone_grain
