!> Laminar flow in a round pipe that cuts through cells.
module pipe_flow
  use communicator, only: communicator_t
  use constants, only: pi
  use gas, only: gas_t
  use gas_cases, only: scene_t, make_gas, steps
  use kinds, only: wp
  use laminar_flows, only: flow_scene
  use mesh_scenes, only: mesh, tube
  use outcome, only: outcome_t
  use surface, only: new_surface
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: pipe, pipe_flow_error

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

  !> Flow through a pipe n cells across, its axis somewhere between the middles of cells, driven by a pressure drop:
  !> the error of the volume flow over pi R^4 dp/dy/(8 mu), and the largest of the mass balance. With segments it is made of
  !> triangles and goes on beyond the domain.
  subroutine pipe_flow_error(comm, n, error, imbalance, ok, segments)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n
    real(wp), intent(out) :: error, imbalance
    logical, intent(out) :: ok  !< whether the steps converged
    integer, intent(in), optional :: segments

    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: edge, flow, start(3)

    edge = 2*radius*(n + 2.0_wp)/n
    scene = flow_scene([edge, length, edge], [n + 2, 8, n + 2], [.false., .true., .false.])
    scene%settings%pressure_drop = [0.0_wp, drop, 0.0_wp]
    allocate (scene%records(0))
    start = [0.5_wp*edge + 0.21_wp*edge/(n + 2), 0.0_wp, 0.5_wp*edge - 0.13_wp*edge/(n + 2)]
    scene%walls = [pipe(start, 2, radius)]
    if (present(segments)) then
      scene%walls(1) = mesh()
      scene%walls(1)%gas_side = 'inside'
      start(2) = -0.2_wp*length
      scene%surfaces = [new_surface(tube(start, [0.0_wp, 1.3_wp*length, 0.0_wp], [radius, radius], segments))]
    end if
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 4, 10.0_wp)
    associate (m => gas%boxes%n)
      flow = comm%sum(sum(gas%flux(1:m(1), 1:m(2), 1:m(3), 2)))/(gas%mesh%n(2)*gas%density)
      imbalance = comm%max(maxval(abs(gas%imbalance)))
    end associate
    imbalance = imbalance/(flow*gas%density)
    error = flow/(pi*radius**4*drop/length/(8*gas%viscosity)) - 1
    call gas%destroy()
  end subroutine pipe_flow_error

end module pipe_flow
