!> How parcels move: a kick by the forces of the middle of the step, between two drifts of half a step.
!>
!>   x += dt/2 v;   v += dt (F/(W m) + drive);   omega += dt T/I;   x += dt/2 v,     I = (2/5) W m r^2
!>
!> Second order, exact for a constant acceleration, positions and velocities known at the same time. Between
!> the steps of one advance the two half drifts are one.
!>
!> Dashpots need velocities of the middle of the step, where the forces are: those of its start with a lead of dt/2
!> times the acceleration of the step before. While parcels advance, `state` holds velocities and spins with their lead,
!> which contacts read, and `aside` holds them without; between advances `state` has them as they are and `aside` the lead. That of
!> the first step is by the forces at its start.
module motion
  use kinds, only: wp
  use parcels, only: parcels_t, coupled_rows, drive_row, frictional_rows, frictional_force_rows, frictionless_force_rows
  implicit none
  private
  public :: start_lead, add_lead, take_lead, drift, kick_and_drift, farthest

  real(wp), parameter :: per_inertia = 2.5_wp  !< W m r^2 / I of a sphere [-]

contains

  !> Leads by the forces where parcels are, which are forgotten.
  pure subroutine start_lead(parcels, gravity, dt)
    type(parcels_t), intent(inout) :: parcels
    real(wp), intent(in) :: gravity(3)      !< the drive where there is no gas to give one [m/s2]
    real(wp), intent(in) :: dt              !< [s]

    real(wp) :: drive(3)
    integer :: i

    drive = gravity
    do i = 1, parcels%n
      if (parcels%with_gas) drive = parcels%coupled(drive_row:drive_row + 2, i)
      parcels%aside(1:3, i) = 0.5_wp*dt*(parcels%state(8, i)*parcels%force(1:3, i) + drive)
      if (parcels%rotation) parcels%aside(4:6, i) = 0.5_wp*dt*per_inertia*parcels%state(8, i)*parcels%force(5:7, i)
      parcels%force(:, i) = 0.0_wp
    end do
  end subroutine start_lead

  !> Before parcels advance.
  pure subroutine add_lead(parcels)
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: v(3)
    integer :: i

    do i = 1, parcels%n
      v = parcels%state(5:7, i)
      parcels%state(5:7, i) = v + parcels%aside(1:3, i)
      parcels%aside(1:3, i) = v
      if (.not. parcels%rotation) cycle
      v = parcels%state(9:11, i)
      parcels%state(9:11, i) = v + parcels%aside(4:6, i)
      parcels%aside(4:6, i) = v
    end do
  end subroutine add_lead

  !> After parcels have advanced.
  pure subroutine take_lead(parcels)
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: v(3)
    integer :: i

    do i = 1, parcels%n
      v = parcels%aside(1:3, i)
      parcels%aside(1:3, i) = parcels%state(5:7, i) - v
      parcels%state(5:7, i) = v
      if (.not. parcels%rotation) cycle
      v = parcels%aside(4:6, i)
      parcels%aside(4:6, i) = parcels%state(9:11, i) - v
      parcels%state(9:11, i) = v
    end do
  end subroutine take_lead

  !> Move all parcels on at their velocity.
  pure subroutine drift(parcels, time, fastest)
    type(parcels_t), intent(inout) :: parcels
    real(wp), intent(in) :: time      !< [s]
    real(wp), intent(out) :: fastest  !< square of the largest speed [m2/s2]

    integer :: i

    fastest = 0.0_wp
    do i = 1, parcels%n
      associate (x => parcels%state(1:3, i), v => parcels%aside(1:3, i))
        x = x + time*v
        fastest = max(fastest, v(1)**2 + v(2)**2 + v(3)**2)
      end associate
    end do
  end subroutine drift

  !> Kick by force and drive, drift, and forget the forces. `energy`, to which the squared speeds are added, is not a
  !> number afterwards if any velocity is none.
  pure subroutine kick_and_drift(parcels, columns, gravity, times, fastest, energy)
    type(parcels_t), intent(inout) :: parcels
    integer, intent(in) :: columns(2)       !< first and last of the parcels
    real(wp), intent(in) :: gravity(3)      !< the drive where there is no gas to give one [m/s2]
    real(wp), intent(in) :: times(2)        !< of the kick, of the drift [s]
    real(wp), intent(inout) :: fastest      !< square of the largest speed so far [m2/s2]
    real(wp), intent(inout) :: energy       !< [m2/s2]

    real(wp) :: drive(coupled_rows, 1)

    if (parcels%with_gas) then
      call move(size(parcels%state, 1), columns, parcels%coupled, 1, times, parcels%state, parcels%aside, parcels%force, &
                fastest, energy)
    else
      drive = 0.0_wp
      drive(1:3, 1) = gravity
      call move(size(parcels%state, 1), columns, drive, 0, times, parcels%state, parcels%aside, parcels%force, fastest, energy)
    end if
  end subroutine kick_and_drift

  !> The loop itself. Column 1 + (i-1)*stride of `drive` belongs to parcel i.
  pure subroutine move(rows, columns, drive, stride, times, state, aside, force, fastest, energy)
    integer, intent(in) :: rows, columns(2), stride
    real(wp), intent(in) :: drive(coupled_rows, *)      !< 1:3 [m/s2]
    real(wp), intent(in) :: times(2)                    !< of the kick, of the drift [s]
    real(wp), intent(inout) :: state(rows, *), aside(merge(6, 3, rows == frictional_rows), *)
    real(wp), intent(inout) :: force(merge(frictional_force_rows, frictionless_force_rows, rows == frictional_rows), *)
    real(wp), intent(inout) :: fastest, energy

    real(wp) :: v(3), spin(3), gain(3), square, per_mass
    integer :: i, column

    do i = columns(1), columns(2)
      column = 1 + (i - 1)*stride
      per_mass = times(1)*state(8, i)
      gain = per_mass*force(1:3, i) + times(1)*drive(1:3, column)
      v = aside(1:3, i) + gain
      aside(1:3, i) = v
      state(5:7, i) = v + 0.5_wp*gain
      state(1:3, i) = state(1:3, i) + times(2)*v
      if (rows == frictional_rows) then
        gain = per_inertia*per_mass*force(5:7, i)
        spin = aside(4:6, i) + gain
        aside(4:6, i) = spin
        state(9:11, i) = spin + 0.5_wp*gain
        force(5:8, i) = 0.0_wp
      end if
      force(1:4, i) = 0.0_wp
      square = v(1)*v(1) + v(2)*v(2) + v(3)*v(3)
      fastest = max(fastest, square)
      energy = energy + square
    end do
  end subroutine move

  !> The longest way any of my parcels has gone since the lists were made [m].
  pure function farthest(parcels)
    type(parcels_t), intent(in) :: parcels
    real(wp) :: farthest

    real(wp) :: square
    integer :: i

    square = 0.0_wp
    do i = 1, parcels%n
      square = max(square, sum((parcels%state(1:3, i) - parcels%built(:, i))**2))
    end do
    farthest = sqrt(square)
  end function farthest

end module motion
