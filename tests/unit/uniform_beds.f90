!> Beds of one size and one void fraction in a column of gas, a parcel in the middle of every cell, which it does not leave.
module uniform_beds
  use boundary_settings, only: boundary_settings_t
  use check, only: expect
  use communicator, only: communicator_t
  use constants, only: pi
  use coupling_scene, only: scene_t, build, add, refill, set_gas, gravity, viscosity, density
  use drag_law, only: drag_law_t, new_drag_law
  use kinds, only: wp
  use parcels, only: velocity_row, drive_row
  implicit none
  private
  public :: packed_gradient, carried_velocity, settling_velocity

  real(wp), parameter :: edge = 0.02_wp  !< of the column, twice as high [m]

contains

  !> The pressure gradient in a bed, of grains too heavy to be moved, while gas flows through it [Pa/m].
  function packed_gradient(comm, drag, d, eps, velocity) result(gradient)
    type(communicator_t), intent(in) :: comm
    character(len=*), intent(in) :: drag
    real(wp), intent(in) :: d, eps, velocity  !< [m], [-], superficial [m/s]
    real(wp) :: gradient

    type(scene_t) :: scene
    integer :: i, n

    call make_column(comm, drag, d, 1.0e12_wp, eps, velocity, scene)
    n = scene%parcels%n
    do i = 1, 4
      call advance(scene, 1.0e-4_wp)
      scene%parcels%state(velocity_row:velocity_row + 2, :n) = 0.0_wp
    end do
    gradient = (scene%gas%pressure(1, 3, 1) - scene%gas%pressure(1, 6, 1))/(3*scene%mesh%finest(2))
    call scene%gas%destroy()
  end function packed_gradient

  !> The superficial velocity of a gas relative to grains that it carries when all else is over, in a column through which gas
  !> flows at half of that [m/s].
  function settling_velocity(comm, drag, d, solid_density, eps) result(velocity)
    type(communicator_t), intent(in) :: comm
    character(len=*), intent(in) :: drag
    real(wp), intent(in) :: d, solid_density, eps
    real(wp) :: velocity

    type(scene_t) :: scene
    real(wp) :: dt, expected
    integer :: i

    expected = carried_velocity(drag, d, solid_density, eps)
    call make_column(comm, drag, d, solid_density, eps, 0.5_wp*expected, scene)
    scene%gas%gravity = gravity
    dt = 0.2_wp*expected/(eps**2*abs(gravity(2)))
    do i = 1, 120
      call advance(scene, dt)
    end do
    velocity = 0.5_wp*expected - eps*scene%parcels%state(velocity_row + 1, 1)
    call scene%gas%destroy()
  end function settling_velocity

  !> The superficial velocity at which gas carries a bed, 18 Re F = eps Ar with Ar = g rho (rho_p - rho) d^3/mu^2 [m/s].
  function carried_velocity(drag, d, solid_density, eps) result(velocity)
    character(len=*), intent(in) :: drag
    real(wp), intent(in) :: d, solid_density, eps  !< [m], [kg/m3], [-]
    real(wp) :: velocity

    type(drag_law_t) :: law
    real(wp) :: low, high, re, archimedes
    integer :: i

    law = new_drag_law(drag)
    archimedes = -gravity(2)*density*(solid_density - density)*d**3/viscosity**2
    low = 0.0_wp
    high = 1000.0_wp
    do i = 1, 60
      re = (low + high)/2
      if (18*re*law%factor_at(re, eps) < eps*archimedes) then
        low = re
      else
        high = re
      end if
    end do
    velocity = re*viscosity/(density*d)
  end function carried_velocity

  subroutine make_column(comm, drag, d, solid_density, eps, velocity, scene)
    type(communicator_t), intent(in) :: comm
    character(len=*), intent(in) :: drag
    real(wp), intent(in) :: d, solid_density, eps, velocity
    type(scene_t), intent(inout) :: scene

    type(boundary_settings_t) :: records(2)
    integer :: i, j, k

    call build(comm, edge, [2, 8, 2], [.true., .false., .true.], drag, scene)
    records(1)%kind = 'inflow'
    records(1)%lower = [0.0_wp, 0.0_wp, 0.0_wp]
    records(1)%upper = [edge, 0.0_wp, edge]
    records(1)%velocity = velocity
    records(2)%kind = 'outflow'
    records(2)%lower = [0.0_wp, 2*edge, 0.0_wp]
    records(2)%upper = [edge, 2*edge, edge]
    call refill(scene, records)
    call set_gas(scene, [0.0_wp, velocity/eps, 0.0_wp], spread(0.0_wp, 1, 3))
    do k = 1, 2
      do j = 1, 8
        do i = 1, 2
          call add(scene, scene%mesh%finest*([i, j, k] - 0.5_wp), spread(0.0_wp, 1, 3), d, solid_density, &
                   (1 - eps)*product(scene%mesh%finest)/(pi/6*d**3))
        end do
      end do
    end do
    call scene%coupling%map_void_fraction(scene%parcels, scene%gas)
    call scene%gas%accept()
  end subroutine make_column

  !> One step of both; the parcels keep their places.
  subroutine advance(scene, dt)
    type(scene_t), intent(inout) :: scene
    real(wp), intent(in) :: dt  !< [s]

    logical :: converged

    call scene%coupling%prepare(scene%parcels, scene%gas, dt, as_seen=.false.)
    call scene%gas%advance(dt, converged)
    if (.not. converged) call expect(.false., 'a uniform bed: the gas converges')
    call scene%gas%accept()
    call scene%coupling%drive(scene%parcels, scene%gas, dt)
    associate (parcels => scene%parcels)
      parcels%state(velocity_row:velocity_row + 2, :parcels%n) = parcels%state(velocity_row:velocity_row + 2, :parcels%n) &
        + dt*parcels%coupled(drive_row:drive_row + 2, :parcels%n)
    end associate
  end subroutine advance

end module uniform_beds
