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
  use parcels, only: parcels_t, coupled_rows, drive_row, velocity_row, frictional_rows, frictionless_rows, force_place
  implicit none
  private
  public :: start_lead, add_lead, take_lead, drift, kick_and_drift, note_places, farthest, fastest_speed

  real(wp), parameter :: moving(4) = [1, 1, 1, 0]  !< what moves of a row: the inverse mass and that of the radius stay
  real(wp), parameter :: per_inertia = 2.5_wp  !< W m r^2 / I of a sphere [-]

contains

  !> Leads of some parcels by the forces where they are, which are forgotten.
  pure subroutine start_lead(parcels, columns, gravity, dt)
    type(parcels_t), intent(inout) :: parcels
    integer, intent(in) :: columns(2)       !< first and last
    real(wp), intent(in) :: gravity(3)      !< the drive where there is no gas to give one [m/s2]
    real(wp), intent(in) :: dt              !< [s]

    real(wp) :: drive(3)
    integer :: i, at

    drive = gravity
    do i = columns(1), columns(2)
      if (parcels%with_gas) drive = parcels%coupled(drive_row:drive_row + 2, i)
      at = parcels%force_at(i)
      associate (force => parcels%force(at:at + size(parcels%aside, 1) - 1), per_mass => parcels%state(8, i))
        parcels%aside(:, i) = 0.0_wp
        parcels%aside(1:3, i) = 0.5_wp*dt*(per_mass*force(1:3) + drive)
        if (parcels%rotation) parcels%aside(5:7, i) = 0.5_wp*dt*per_inertia*per_mass*force(5:7)
        force = 0.0_wp
      end associate
    end do
  end subroutine start_lead

  !> Before parcels advance.
  pure subroutine add_lead(parcels)
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: v(size(parcels%aside, 1))
    integer :: i

    do i = 1, parcels%n
      v = parcels%state(velocity_row:, i)
      parcels%state(velocity_row:, i) = v + parcels%aside(:, i)
      parcels%aside(:, i) = v
    end do
  end subroutine add_lead

  !> After parcels have advanced.
  pure subroutine take_lead(parcels)
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: v(size(parcels%aside, 1))
    integer :: i

    do i = 1, parcels%n
      v = parcels%aside(:, i)
      parcels%aside(:, i) = parcels%state(velocity_row:, i) - v
      parcels%state(velocity_row:, i) = v
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

    associate (p => parcels)
      if (p%with_gas .and. p%rotation) then
        call move_spinning(columns, p%coupled, 1, times, p%ring, p%state, p%aside, p%force(p%force_start), fastest, energy)
      else if (p%with_gas) then
        call move_smooth(columns, p%coupled, 1, times, p%ring, p%state, p%aside, p%force(p%force_start), fastest, energy)
      else
        drive = 0.0_wp
        drive(1:3, 1) = gravity
        if (p%rotation) then
          call move_spinning(columns, drive, 0, times, p%ring, p%state, p%aside, p%force(p%force_start), fastest, energy)
        else
          call move_smooth(columns, drive, 0, times, p%ring, p%state, p%aside, p%force(p%force_start), fastest, energy)
        end if
      end if
    end associate
  end subroutine kick_and_drift

  !> The loop itself, all that has a velocity at once: W3 is some 3 % faster than with four rows at a time, which would be one loop
  !> with `move_smooth`. Column 1 + (i-1)*stride of `drive` belongs to parcel i.
  pure subroutine move_spinning(columns, drive, stride, times, ring, state, aside, force, fastest, energy)
    integer, intent(in) :: columns(2), stride
    real(wp), intent(in) :: drive(coupled_rows, *)      !< 1:3 [m/s2]
    real(wp), intent(in) :: times(2)                    !< of the kick, of the drift [s]
    integer, intent(in) :: ring                         !< see force_place
    real(wp), intent(inout) :: state(frictional_rows, *), aside(8, *), force(8, 0:*)
    real(wp), intent(inout) :: fastest, energy

    real(wp) :: v(8), gain(8), kick(8), push(8), way(4), square
    integer :: i, l, column, place

    kick = times(1)*[moving, per_inertia*moving]
    push = times(1)*[moving, 0*moving]
    way = times(2)*moving
    do i = columns(1), columns(2)
      column = 1 + (i - 1)*stride
      place = force_place(i, i, ring)
      !$omp simd simdlen(8)
      do l = 1, 8
        gain(l) = kick(l)*state(8, i)*force(l, place) + push(l)*drive(l, column)
        v(l) = aside(l, i) + gain(l)
        aside(l, i) = v(l)
        force(l, place) = 0.0_wp
      end do
      !$omp simd simdlen(8)
      do l = 1, 8
        state(l + 4, i) = v(l) + 0.5_wp*gain(l)
      end do
      !$omp simd simdlen(4)
      do l = 1, 4
        state(l, i) = state(l, i) + way(l)*v(l)
      end do
      square = v(1)*v(1) + v(2)*v(2) + v(3)*v(3)
      fastest = max(fastest, square)
      energy = energy + square
    end do
  end subroutine move_spinning

  !> The same without spin.
  pure subroutine move_smooth(columns, drive, stride, times, ring, state, aside, force, fastest, energy)
    integer, intent(in) :: columns(2), stride
    real(wp), intent(in) :: drive(coupled_rows, *)
    real(wp), intent(in) :: times(2)
    integer, intent(in) :: ring
    real(wp), intent(inout) :: state(frictionless_rows, *), aside(4, *), force(4, 0:*)
    real(wp), intent(inout) :: fastest, energy

    real(wp) :: v(4), gain(4), kick(4), way(4), square
    integer :: i, l, column, place

    kick = times(1)*moving
    way = times(2)*moving
    do i = columns(1), columns(2)
      column = 1 + (i - 1)*stride
      place = force_place(i, i, ring)
      !$omp simd simdlen(4)
      do l = 1, 4
        gain(l) = kick(l)*(state(8, i)*force(l, place) + drive(l, column))
        v(l) = aside(l, i) + gain(l)
        aside(l, i) = v(l)
        force(l, place) = 0.0_wp
      end do
      !$omp simd simdlen(4)
      do l = 1, 4
        state(l + 4, i) = v(l) + 0.5_wp*gain(l)
        state(l, i) = state(l, i) + way(l)*v(l)
      end do
      square = v(1)*v(1) + v(2)*v(2) + v(3)*v(3)
      fastest = max(fastest, square)
      energy = energy + square
    end do
  end subroutine move_smooth

  !> From here on the ways of parcels count.
  pure subroutine note_places(parcels)
    type(parcels_t), intent(inout) :: parcels

    integer :: i

    do i = 1, parcels%n
      parcels%built(:, i) = parcels%state(1:3, i)
    end do
  end subroutine note_places

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

  !> Of any of my parcels [m/s].
  pure function fastest_speed(parcels)
    type(parcels_t), intent(in) :: parcels
    real(wp) :: fastest_speed

    real(wp) :: square
    integer :: i

    square = 0.0_wp
    do i = 1, parcels%n
      square = max(square, sum(parcels%state(5:7, i)**2))
    end do
    fastest_speed = sqrt(square)
  end function fastest_speed

end module motion
