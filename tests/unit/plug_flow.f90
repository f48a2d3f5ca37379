!> A plug of gas between slip sides, along any axis, from or to a plane that cuts cells.
module plug_flow
  use boundary_settings, only: boundary_settings_t
  use communicator, only: communicator_t
  use gas, only: gas_t
  use gas_cases, only: scene_t, record
  use kinds, only: wp
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: walls_record, plane_across, plug_scene, slip_sides, plug_errors

  real(wp), parameter :: o = 0.0_wp
  real(wp), parameter, public :: edge = 2.0e-3_wp  !< of a cell [m]

contains

  !> All walls within the domain.
  function walls_record(scene, kind) result(walls)
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: kind
    type(boundary_settings_t) :: walls

    walls = record('walls', kind, [o, o, o], scene%upper)
    walls%surface = 'walls'
  end function walls_record

  pure function plane_across(a, side, height) result(wall)
    integer, intent(in) :: a
    integer, intent(in) :: side        !< 1: the gas is above the plane, -1: below
    real(wp), intent(in) :: height     !< [m]
    type(wall_settings_t) :: wall

    wall%kind = 'plane'
    wall%gas_side = 'inside'
    wall%normal = o
    wall%normal(a) = side
    wall%point = height
    wall%rotation_centre = height
  end function plane_across

  !> 4 by 4 cells, so many along a, of a gas whose steps end near round-off.
  function plug_scene(a, long) result(scene)
    integer, intent(in) :: a, long
    type(scene_t) :: scene

    scene%cells = 4
    scene%cells(a) = long
    scene%upper = scene%cells*edge
    scene%numerics%tolerance = 1.0e-12_wp
    scene%numerics%velocity_tolerance = 1.0e-12_wp
    scene%numerics%maximum_iterations = 100
  end function plug_scene

  !> Slip sides along a, and at the end of a that is on this side of the middle a region of some kind.
  subroutine slip_sides(scene, a, side, kind)
    type(scene_t), intent(inout) :: scene
    integer, intent(in) :: a, side  !< see plane_across; 0: no region across a
    character(len=*), intent(in) :: kind

    real(wp) :: low(3), high(3)
    integer :: b, end

    do b = 1, 3
      do end = 1, 2
        if (b == a .and. 2*end - 3 /= side) cycle
        low = o
        high = scene%upper
        if (end == 1) high(b) = o
        if (end == 2) low(b) = high(b)
        if (b == a) scene%records = [scene%records, record('end', kind, low, high)]
        if (b /= a) scene%records = [scene%records, record('side', 'slip', low, high)]
      end do
    end do
  end subroutine slip_sides

  !> How far the gas is from a plug of a velocity and a pressure: along it [m/s], across it [m/s], and over rho u^2 [-].
  function plug_errors(comm, gas, a, velocity, pressure) result(worst)
    type(communicator_t), intent(in) :: comm
    type(gas_t), intent(in) :: gas
    integer, intent(in) :: a
    real(wp), intent(in) :: velocity, pressure  !< [m/s], [Pa]
    real(wp) :: worst(3)

    associate (n => gas%boxes%n, u => gas%velocity, open => .not. gas%space%closed)
      worst(1) = maxval(abs(u(1:n(1), 1:n(2), 1:n(3), a) - velocity), gas%space%area(1:n(1), 1:n(2), 1:n(3), a) > o)
      worst(2) = sum(abs(u(1:n(1), 1:n(2), 1:n(3), :))) - sum(abs(u(1:n(1), 1:n(2), 1:n(3), a)))
      worst(3) = maxval(abs(gas%pressure(1:n(1), 1:n(2), 1:n(3)) - pressure), open)/(gas%density*velocity**2)
    end associate
    worst = comm%max(worst)
  end function plug_errors

end module plug_flow
