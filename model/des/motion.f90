!> How parcels move: a kick by the forces of the middle of the step, between two drifts of half a step.
!>
!>   x += dt/2 v;   v += dt (F/(W m) + drive);   omega += dt T/I;   x += dt/2 v,     I = (2/5) W m r^2
!>
!> Second order, exact for a constant acceleration, positions and velocities known at the same time. Between
!> the steps of one advance the two half drifts are one.
module motion
  use kinds, only: wp
  use parcels, only: parcels_t, coupled_rows, frictional_rows
  implicit none
  private
  public :: drift, kick_and_drift

  real(wp), parameter :: per_inertia = 2.5_wp  !< W m r^2 / I of a sphere [-]

contains

  !> Move all parcels on at their velocity.
  pure subroutine drift(parcels, time, fastest)
    type(parcels_t), intent(inout) :: parcels
    real(wp), intent(in) :: time      !< [s]
    real(wp), intent(out) :: fastest  !< square of the largest speed [m2/s2]

    integer :: i

    fastest = 0.0_wp
    do i = 1, parcels%n
      associate (x => parcels%state(1:3, i), v => parcels%state(5:7, i))
        x = x + time*v
        fastest = max(fastest, v(1)**2 + v(2)**2 + v(3)**2)
      end associate
    end do
  end subroutine drift

  !> Kick by force and drive, drift, and forget the forces. `energy`, the sum of the squared speeds, is not a
  !> number if any velocity is none.
  pure subroutine kick_and_drift(parcels, gravity, dt, time, fastest, energy)
    type(parcels_t), intent(inout) :: parcels
    real(wp), intent(in) :: gravity(3)  !< the drive where there is no gas to give one [m/s2]
    real(wp), intent(in) :: dt          !< of the kick [s]
    real(wp), intent(in) :: time        !< of the drift [s]
    real(wp), intent(out) :: fastest    !< square of the largest speed [m2/s2]
    real(wp), intent(out) :: energy     !< [m2/s2]

    real(wp) :: drive(coupled_rows, 1)

    if (parcels%with_gas) then
      call move(size(parcels%state, 1), parcels%n, parcels%coupled, 1, [dt, time], parcels%state, parcels%force, &
                fastest, energy)
    else
      drive = 0.0_wp
      drive(1:3, 1) = gravity
      call move(size(parcels%state, 1), parcels%n, drive, 0, [dt, time], parcels%state, parcels%force, &
                fastest, energy)
    end if
  end subroutine kick_and_drift

  !> The loop itself. Column 1 + (i-1)*stride of `drive` belongs to parcel i.
  pure subroutine move(rows, n, drive, stride, times, state, force, fastest, energy)
    integer, intent(in) :: rows, n, stride
    real(wp), intent(in) :: drive(coupled_rows, *)      !< 1:3 [m/s2]
    real(wp), intent(in) :: times(2)                    !< of the kick, of the drift [s]
    real(wp), intent(inout) :: state(rows, *), force(rows/2, *)
    real(wp), intent(out) :: fastest, energy

    real(wp) :: v(3), square, per_mass, twist
    integer :: i, column

    fastest = 0.0_wp
    energy = 0.0_wp
    do i = 1, n
      column = 1 + (i - 1)*stride
      per_mass = times(1)*state(8, i)
      v = state(5:7, i) + (per_mass*force(1:3, i) + times(1)*drive(1:3, column))
      state(5:7, i) = v
      state(1:3, i) = state(1:3, i) + times(2)*v
      if (rows == frictional_rows) then
        twist = per_inertia*per_mass
        state(9:11, i) = state(9:11, i) + twist*force(5:7, i)
        force(5:8, i) = 0.0_wp
      end if
      force(1:4, i) = 0.0_wp
      square = v(1)*v(1) + v(2)*v(2) + v(3)*v(3)
      fastest = max(fastest, square)
      energy = energy + square
    end do
  end subroutine move

end module motion
