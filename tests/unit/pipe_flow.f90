!> Laminar flow in pipes whose walls cut through cells.
module pipe_flow
  use communicator, only: communicator_t
  use constants, only: pi
  use gas, only: gas_t
  use gas_cases, only: scene_t, make_gas, steps
  use kinds, only: wp
  use laminar_flows, only: flow_scene, viscosity
  use mesh_scenes, only: mesh, tube
  use outcome, only: outcome_t
  use surface, only: new_surface
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: pipe, round_scene, pipe_flow_error, turned_duct_error

  real(wp), parameter :: radius = 0.01_wp, length = 0.02_wp, drop = 2.4_wp

contains

  !> A pipe along an axis without ends.
  pure function pipe(point, a, radius) result(wall)
    real(wp), intent(in) :: point(3), radius  !< [m]
    integer, intent(in) :: a
    type(wall_settings_t) :: wall

    wall%kind = 'cylinder'
    wall%gas_side = 'inside'
    wall%point = point
    wall%axis = 0.0_wp
    wall%axis(a) = 1.0_wp
    wall%radius = radius
    wall%rotation_centre = point
  end function pipe

  !> A periodic piece of a box along y, driven by a pressure drop, n cells over a width in x and z and one more at either end; the
  !> axis of what is in it lies somewhere between the middles of cells.
  subroutine make_scene(n, width, scene, axis)
    integer, intent(in) :: n
    real(wp), intent(in) :: width  !< [m]
    type(scene_t), intent(out) :: scene
    real(wp), intent(out) :: axis(3)  !< a point of it [m]

    real(wp) :: cell

    cell = width/n
    scene = flow_scene([(n + 2)*cell, length, (n + 2)*cell], [n + 2, 8, n + 2], [.false., .true., .false.])
    scene%settings%pressure_drop = [0.0_wp, drop, 0.0_wp]
    allocate (scene%records(0))
    axis = [0.5_wp*scene%upper(1) + 0.21_wp*cell, 0.0_wp, 0.5_wp*scene%upper(3) - 0.13_wp*cell]
  end subroutine make_scene

  !> A slice periodic along y, n cells over a width in x and z and one more at either end, of a gas as thick as oil.
  subroutine round_scene(n, radius, scene, axis)
    integer, intent(in) :: n
    real(wp), intent(in) :: radius  !< [m]
    type(scene_t), intent(out) :: scene
    real(wp), intent(out) :: axis(3)  !< a point of it [m]

    real(wp) :: h

    h = 2*radius/n
    scene = flow_scene([n + 2, 3, n + 2]*h, [n + 2, 3, n + 2], [.false., .true., .false.])
    scene%settings%pressure_drop = 0.0_wp
    allocate (scene%records(0))
    scene%numerics%velocity_tolerance = 1.0e-7_wp
    axis = 0.5_wp*scene%upper + [0.21_wp, 0.0_wp, -0.13_wp]*h
  end subroutine round_scene

  !> The steady volume flow, the largest error of the mass balance over it, and velocities in cells that are not cut.
  subroutine find_flow(comm, scene, axis, flow, imbalance, ok, profile)
    type(communicator_t), intent(in) :: comm
    type(scene_t), intent(in) :: scene
    real(wp), intent(in) :: axis(3)
    real(wp), intent(out) :: flow, imbalance  !< [m3/s], [-]
    logical, intent(out) :: ok                !< whether the steps converged
    real(wp), allocatable, intent(out), optional :: profile(:,:)  !< (2,cells) distance from the axis [m], velocity [m/s]

    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: x(3)
    integer :: i, k

    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 4, 10.0_wp)
    associate (m => gas%boxes%n)
      flow = comm%sum(sum(gas%flux(1:m(1), 1:m(2), 1:m(3), 2)))/(gas%mesh%n(2)*gas%density)
      imbalance = comm%max(maxval(abs(gas%imbalance)))/(flow*gas%density)
      if (present(profile)) then
        allocate (profile(2, 0))
        do k = 1, m(3)
          do i = 1, m(1)
            if (gas%space%area(i, 1, k, 2) < 1.0_wp) cycle
            x = gas%mesh%in_metres(gas%boxes%lo + [i, 1, k] - 1.5_wp) - axis
            profile = reshape([profile, hypot(x(1), x(3)), gas%velocity(i, 1, k, 2)], [2, size(profile, 2) + 1])
          end do
        end do
      end if
    end associate
    call gas%destroy()
  end subroutine find_flow

  !> Flow through a round pipe n cells across: its error over pi R^4 dp/dy/(8 mu). With segments it is made of triangles and goes on
  !> beyond the domain.
  subroutine pipe_flow_error(comm, n, error, imbalance, ok, segments, profile)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n
    real(wp), intent(out) :: error, imbalance
    logical, intent(out) :: ok  !< whether the steps converged
    integer, intent(in), optional :: segments
    real(wp), allocatable, intent(out), optional :: profile(:,:)  !< over radius and largest velocity

    type(scene_t) :: scene
    real(wp) :: flow, axis(3), start(3)

    call make_scene(n, 2*radius, scene, axis)
    scene%walls = [pipe(axis, 2, radius)]
    if (present(segments)) then
      scene%walls(1) = mesh()
      scene%walls(1)%gas_side = 'inside'
      start = axis - [0.0_wp, 0.2_wp*length, 0.0_wp]
      scene%surfaces = [new_surface(tube(start, [0.0_wp, 1.3_wp*length, 0.0_wp], [radius, radius], segments))]
    end if
    call find_flow(comm, scene, axis, flow, imbalance, ok, profile)
    error = flow/(pi*radius**4*drop/length/(8*viscosity)) - 1
    if (.not. present(profile)) return
    profile(1, :) = profile(1, :)/radius
    profile(2, :) = profile(2, :)/(radius**2*drop/length/(4*viscosity))
  end subroutine pipe_flow_error

  !> Flow through a square duct whose walls are turned against the grid by an angle of tangent 1/2: its error over that of the
  !> series of White, Viscous Fluid Flow, eq. 3-48, integrated.
  subroutine turned_duct_error(comm, n, error, ok)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n
    real(wp), intent(out) :: error
    logical, intent(out) :: ok  !< whether the steps converged

    real(wp), parameter :: normal(3) = [2.0_wp, 0.0_wp, 1.0_wp]/sqrt(5.0_wp), other(3) = [-1.0_wp, 0.0_wp, 2.0_wp]/sqrt(5.0_wp)
    type(scene_t) :: scene
    type(wall_settings_t) :: wall
    real(wp) :: flow, imbalance, axis(3), series
    integer :: m

    call make_scene(n, 2*radius*3/sqrt(5.0_wp), scene, axis)
    wall%kind = 'plane'
    wall%gas_side = 'inside'
    wall%rotation_centre = 0.0_wp
    allocate (scene%walls(4), source=wall)
    do m = 1, 4
      scene%walls(m)%normal = merge(1, -1, m > 2)*merge(normal, other, modulo(m, 2) == 0)
      scene%walls(m)%point = axis - radius*scene%walls(m)%normal
    end do
    call find_flow(comm, scene, axis, flow, imbalance, ok)
    series = sum([(tanh(0.5_wp*m*pi)/real(m, wp)**5, m=1, 99, 2)])
    error = flow/(4*radius**4*drop/length/(3*viscosity)*(1 - 192/pi**5*series)) - 1
  end subroutine turned_duct_error

end module pipe_flow
