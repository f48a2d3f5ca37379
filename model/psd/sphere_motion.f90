!> Spheres that push each other apart until none overlap.
!>
!> Every overlap is a linear spring, and the energy of all springs is brought to nothing by damped motion
!> (FIRE: Bitzek et al., Phys. Rev. Lett. 97 (2006) 170201). Spheres are pushed as if they were a little larger
!> than they are, so the motion can end with gaps, not with overlaps that fade for ever. Walls are limits of the
!> position.
module sphere_motion
  use kinds, only: wp
  use random_numbers, only: random_t
  use sphere_pairs, only: spheres_t, pairs_t, find_pairs
  implicit none
  private
  public :: motion_t, relax, inflation

  real(wp), parameter :: inflation = 4.0e-4_wp   !< by which spheres are pushed further apart than touching
  real(wp), parameter :: shaking = 0.05_wp       !< range of a shaken sphere's way over its radius
  integer, parameter :: patience = 300           !< steps between two looks at the energy

  ! FIRE with the constants of its authors. A sphere with 12 contacts moves stably up to a step of 2/sqrt(24).
  real(wp), parameter :: first_step = 0.1_wp, largest_step = 0.4_wp, growth = 1.1_wp, shrinkage = 0.5_wp
  real(wp), parameter :: first_steering = 0.1_wp, steering_decay = 0.99_wp
  integer, parameter :: steps_before_growth = 5

  !> The spheres in motion. Time is counted in sqrt(mass/stiffness), forces in stiffness times length.
  type :: motion_t
    type(spheres_t) :: spheres
    type(pairs_t) :: pairs
    type(random_t) :: random
    integer, allocatable :: number(:)          !< (n) which sphere of the caller's each is
    real(wp), allocatable :: lower(:, :)       !< (3,n) lowest place of each centre [m]
    real(wp), allocatable :: upper(:, :)       !< (3,n) highest place of each centre [m]
    real(wp), allocatable :: listed(:, :)      !< (3,n) position when the pairs were found [m]
    real(wp), allocatable :: velocity(:, :)    !< (3,n) [m]
    real(wp), allocatable :: force(:, :)       !< (3,n) [m]
    real(wp), allocatable :: inverse_mass(:)   !< (n) 0 for spheres held where they are [-]
    real(wp) :: room = 0.0_wp                  !< of the pair list [m]
    real(wp) :: energy = 0.0_wp                !< of all springs [m2]
    real(wp) :: worst = 0.0_wp                 !< largest overlap over the sum of the radii [-]
    real(wp) :: step = first_step              !< of time [-]
    real(wp) :: steering = first_steering      !< share of the velocity turned into the force's direction [-]
    integer :: downhill = 0                    !< steps since the motion last went uphill
  end type motion_t

contains

  !> Move until no spheres overlap, or until the energy hardly falls any more and shaking does not help.
  subroutine relax(motion, jam, jammed)
    type(motion_t), intent(inout) :: motion
    real(wp), intent(in) :: jam  !< share of the energy left after 300 steps that means a jam [-]
    logical, intent(out) :: jammed

    real(wp) :: energy_before
    integer :: steps
    logical :: shaken

    jammed = .false.
    if (size(motion%number) == 0) return
    call start(motion)
    energy_before = huge(1.0_wp)
    shaken = .false.
    steps = 0
    do
      call push_apart(motion)
      if (motion%worst < 0.999_wp*inflation) exit
      if (modulo(steps, patience) == 0) then
        jammed = shaken .and. motion%energy > jam*energy_before
        if (jammed) exit
        shaken = motion%energy > jam*energy_before
        energy_before = motion%energy
        if (shaken) call shake(motion)
      end if
      call steer(motion)
      call drift(motion)
      steps = steps + 1
    end do
    call bring_inside(motion%spheres)
  end subroutine relax

  !> Move every sphere a little. A row along an edge, or a layer on a wall, can be pressed so evenly that no force
  !> leads out of it.
  subroutine shake(motion)
    type(motion_t), intent(inout) :: motion

    integer :: i, a

    do i = 1, size(motion%number)
      if (motion%spheres%box(i) == 0) cycle
      do a = 1, 3
        motion%spheres%position(a, i) = motion%spheres%position(a, i) + &
          shaking*motion%spheres%radius(i)*(motion%random%uniform() - 0.5_wp)
      end do
      motion%spheres%position(:, i) = min(max(motion%spheres%position(:, i), motion%lower(:, i)), motion%upper(:, i))
    end do
    call start(motion)
    call push_apart(motion)
  end subroutine shake

  !> Begin to move, from rest.
  subroutine start(motion)
    type(motion_t), intent(inout) :: motion

    call bring_inside(motion%spheres)
    call list_pairs(motion)
    motion%velocity = 0.0_wp
    motion%step = first_step
    motion%steering = first_steering
    motion%downhill = 0
  end subroutine start

  subroutine list_pairs(motion)
    type(motion_t), intent(inout) :: motion

    call find_pairs(motion%spheres, motion%room, motion%pairs)
    motion%listed(:, :) = motion%spheres%position
  end subroutine list_pairs

  !> Forces of all overlaps of the inflated spheres that can move, the energy and the worst overlap.
  subroutine push_apart(motion)
    type(motion_t), intent(inout) :: motion

    real(wp) :: half(3), length(3), way(3), mine(3), square, touching, overlap
    integer :: i, j, place

    call motion%spheres%vessel%periods(length, half)
    associate (x => motion%spheres%position, radius => motion%spheres%radius)
      motion%force = 0.0_wp
      motion%energy = 0.0_wp
      motion%worst = 0.0_wp
      do i = 1, size(radius)
        mine = 0.0_wp
        do place = motion%pairs%first(i), motion%pairs%first(i + 1) - 1
          j = motion%pairs%with(place)
          way = x(:, j) - x(:, i)
          way = way - merge(length, 0.0_wp, way > half) + merge(length, 0.0_wp, way < -half)
          touching = (1.0_wp + inflation)*(radius(i) + radius(j))
          square = sum(way**2)
          if (square >= touching**2) cycle
          if (max(motion%inverse_mass(i), motion%inverse_mass(j)) <= 0.0_wp) cycle  ! both are held
          overlap = touching - sqrt(square)
          way = way*(overlap/max(sqrt(square), epsilon(1.0_wp)*touching))
          mine = mine - way
          motion%force(:, j) = motion%force(:, j) + way
          motion%energy = motion%energy + 0.5_wp*overlap**2
          motion%worst = max(motion%worst, overlap/(radius(i) + radius(j)))
        end do
        motion%force(:, i) = motion%force(:, i) + mine
      end do
    end associate
  end subroutine push_apart

  !> FIRE: quicker and straighter while the motion goes downhill, a halt where it goes uphill.
  subroutine steer(motion)
    type(motion_t), intent(inout) :: motion

    real(wp) :: power, speed, pull
    integer :: i

    power = sum(motion%force*motion%velocity)
    if (power > 0.0_wp) then
      motion%downhill = motion%downhill + 1
      if (motion%downhill > steps_before_growth) then
        motion%step = min(motion%step*growth, largest_step)
        motion%steering = motion%steering*steering_decay
      end if
    else
      motion%downhill = 0
      motion%step = motion%step*shrinkage
      motion%steering = first_steering
      motion%velocity = 0.0_wp
    end if
    speed = 0.0_wp
    pull = 0.0_wp
    do i = 1, size(motion%inverse_mass)
      motion%force(:, i) = motion%force(:, i)*motion%inverse_mass(i)
      motion%velocity(:, i) = motion%velocity(:, i) + motion%step*motion%force(:, i)
      speed = speed + sum(motion%velocity(:, i)**2)
      pull = pull + sum(motion%force(:, i)**2)
    end do
    if (pull <= 0.0_wp) return
    motion%velocity = (1.0_wp - motion%steering)*motion%velocity + (motion%steering*sqrt(speed/pull))*motion%force
  end subroutine steer

  !> Move the spheres within their boxes, and find the pairs anew when one has gone far.
  subroutine drift(motion)
    type(motion_t), intent(inout) :: motion

    real(wp) :: x(3), furthest, limit
    integer :: i

    furthest = 0.0_wp
    associate (spheres => motion%spheres)
      do i = 1, size(spheres%radius)
        x = spheres%position(:, i) + motion%step*motion%velocity(:, i)
        where (x < motion%lower(:, i) .or. x > motion%upper(:, i)) motion%velocity(:, i) = 0.0_wp
        x = min(max(x, motion%lower(:, i)), motion%upper(:, i))
        spheres%position(:, i) = x
        furthest = max(furthest, sum((x - motion%listed(:, i))**2))
      end do
      limit = 0.5_wp*motion%room - inflation*maxval(spheres%radius)
      if (furthest < limit**2) return
      call bring_inside(spheres)
    end associate
    call list_pairs(motion)
  end subroutine drift

  !> Bring spheres that went through a periodic face of the vessel in through the opposite one.
  pure subroutine bring_inside(spheres)
    type(spheres_t), intent(inout) :: spheres

    integer :: i

    associate (vessel => spheres%vessel)
      do i = 1, size(spheres%radius)
        where (vessel%periodic) spheres%position(:, i) = &
          vessel%lower + modulo(spheres%position(:, i) - vessel%lower, vessel%upper - vessel%lower)
      end do
    end associate
  end subroutine bring_inside

end module sphere_motion
