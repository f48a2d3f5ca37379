!> Placing spheres in boxes without overlap.
!>
!> All spheres start at once, spread evenly over their boxes, and push each other apart. Spheres of several boxes
!> that share space see each other; spheres that are already there are seen and do not move.
!>
!> Equal spheres come to rest without overlap up to a solids fraction of about 0.63, less near walls. Where the
!> motion ends in a jam, spheres are taken out of each box that is jammed, evenly, until the rest fits: this is
!> how much the boxes hold.
module packing
  use constants, only: pi
  use kinds, only: wp
  use random_numbers, only: random_t
  use sphere_motion, only: motion_t, relax, inflation
  use sphere_pairs, only: spheres_t, pairs_t, find_pairs
  implicit none
  private
  public :: box_t, pack_spheres, has_overlap

  !> Where some of the spheres have to stay, surfaces included.
  type :: box_t
    real(wp) :: lower(3)  !< lowest corner [m]
    real(wp) :: upper(3)  !< highest corner [m]
    logical :: spans(3)   !< joined to itself through periodic faces of the vessel
  end type box_t

  real(wp), parameter :: room_share = 0.45_wp  !< room of the pair list over the mean diameter
  real(wp), parameter :: fullest = 0.74_wp     !< solids fraction of the densest packing of equal spheres
  real(wp), parameter :: jam = 0.9_wp          !< share of the energy left in a motion that is jammed
  real(wp), parameter :: jam_again = 0.5_wp    !< the same when spheres have been taken out already

contains

  !> Place the spheres in their boxes; the position of those held (box 0) is kept. Fails by leaving some out.
  subroutine pack_spheres(boxes, random, spheres, placed)
    type(box_t), intent(in) :: boxes(:)
    type(random_t), intent(inout) :: random
    type(spheres_t), intent(inout) :: spheres
    logical, allocatable, intent(out) :: placed(:)  !< (n) all, unless the boxes are too small

    type(motion_t) :: motion
    logical :: jammed
    integer :: i

    call spread_out(boxes, random, spheres)
    allocate (placed(size(spheres%radius)), source=.true.)
    call trim_to_fullest(boxes, spheres, placed)
    call start_motion(boxes, spheres, placed, motion)
    motion%random = random
    call relax(motion, jam, jammed)
    do while (jammed)
      call take_out(size(boxes), motion)
      call relax(motion, jam_again, jammed)
    end do
    placed = .false.
    do i = 1, size(motion%number)
      placed(motion%number(i)) = .true.
      spheres%position(:, motion%number(i)) = motion%spheres%position(:, i)
    end do
  end subroutine pack_spheres

  !> Whether any two spheres overlap, at least one of which was to be placed.
  function has_overlap(spheres)
    type(spheres_t), intent(in) :: spheres
    logical :: has_overlap

    type(pairs_t) :: pairs
    integer :: i

    call find_pairs(spheres, 0.0_wp, pairs)
    has_overlap = .false.
    do i = 1, size(spheres%radius)
      associate (others => pairs%with(pairs%first(i):pairs%first(i + 1) - 1))
        if (size(others) == 0) cycle
        has_overlap = has_overlap .or. spheres%box(i) > 0 .or. any(spheres%box(others) > 0)
      end associate
    end do
  end function has_overlap

  !> One sphere in a cell of a lattice over its box, at a random place of the cell.
  subroutine spread_out(boxes, random, spheres)
    type(box_t), intent(in) :: boxes(:)
    type(random_t), intent(inout) :: random
    type(spheres_t), intent(inout) :: spheres

    real(wp) :: edge, place(3), margin(3)
    integer :: b, i, n, seen, cell, lattice(3)

    do b = 1, size(boxes)
      associate (extent => boxes(b)%upper - boxes(b)%lower)
        n = count(spheres%box == b)
        edge = (product(extent)/max(n, 1))**(1.0_wp/3.0_wp)
        lattice = max(ceiling(extent/edge), 1)
        seen = 0
        do i = 1, size(spheres%box)
          if (spheres%box(i) /= b) cycle
          seen = seen + 1
          cell = int(product(lattice)*((seen - 0.5_wp)/n))
          place = [modulo(cell, lattice(1)), modulo(cell/lattice(1), lattice(2)), cell/(lattice(1)*lattice(2))]
          place = (place + [random%uniform(), random%uniform(), random%uniform()])/lattice
          margin = merge(0.0_wp, spheres%radius(i), boxes(b)%spans)
          spheres%position(:, i) = boxes(b)%lower + margin + place*(extent - 2.0_wp*margin)
        end do
      end associate
    end do
  end subroutine spread_out

  !> Leave out what cannot fit by any means, spread over the spheres of a box.
  subroutine trim_to_fullest(boxes, spheres, placed)
    type(box_t), intent(in) :: boxes(:)
    type(spheres_t), intent(in) :: spheres
    logical, intent(inout) :: placed(:)

    real(wp) :: share, volume
    integer :: b, i, seen

    do b = 1, size(boxes)
      volume = 4.0_wp/3.0_wp*pi*sum(spheres%radius**3, spheres%box == b)
      share = fullest*product(boxes(b)%upper - boxes(b)%lower)/max(volume, tiny(volume))
      if (share >= 1.0_wp) cycle
      seen = 0
      do i = 1, size(spheres%box)
        if (spheres%box(i) /= b) cycle
        seen = seen + 1
        placed(i) = int(seen*share) > int((seen - 1)*share)
      end do
    end do
  end subroutine trim_to_fullest

  !> The spheres placed and all that their motion needs. Larger spheres have more contacts and more mass.
  subroutine start_motion(boxes, spheres, placed, motion)
    type(box_t), intent(in) :: boxes(:)
    type(spheres_t), intent(in) :: spheres
    logical, intent(in) :: placed(:)
    type(motion_t), intent(out) :: motion

    real(wp) :: mean, margin(3)
    integer :: i, n

    n = count(placed)
    allocate (motion%number(n), motion%spheres%position(3, n), motion%spheres%radius(n), motion%spheres%box(n))
    motion%number(:) = pack([(i, i=1, size(placed))], placed)
    motion%spheres%vessel = spheres%vessel
    motion%spheres%position(:, :) = spheres%position(:, motion%number)
    motion%spheres%radius(:) = spheres%radius(motion%number)
    motion%spheres%box(:) = spheres%box(motion%number)
    allocate (motion%lower(3, n), motion%upper(3, n), motion%listed(3, n), motion%inverse_mass(n))
    allocate (motion%velocity(3, n), motion%force(3, n), source=0.0_wp)
    mean = sum(motion%spheres%radius)/max(n, 1)
    motion%room = 2.0_wp*room_share*mean
    do i = 1, n
      if (motion%spheres%box(i) == 0) then
        motion%inverse_mass(i) = 0.0_wp
        motion%lower(:, i) = motion%spheres%position(:, i)
        motion%upper(:, i) = motion%spheres%position(:, i)
      else
        associate (box => boxes(motion%spheres%box(i)), radius => motion%spheres%radius(i))
          margin = merge(-huge(1.0_wp), radius, box%spans)
          motion%inverse_mass(i) = min((mean/radius)**2, 1.0_wp)
          motion%lower(:, i) = min(box%lower + margin, 0.5_wp*(box%lower + box%upper))
          motion%upper(:, i) = max(box%upper - margin, 0.5_wp*(box%lower + box%upper))
        end associate
      end if
    end do
  end subroutine start_motion

  !> Leave out one sphere in a hundred, three where the jam is tight, at least one, of each jammed box.
  subroutine take_out(boxes, motion)
    integer, intent(in) :: boxes
    type(motion_t), intent(inout) :: motion

    logical :: jammed(0:boxes), kept(size(motion%number))
    integer :: b, i, seen, interval

    call find_jams(motion, jammed)
    kept = .true.
    do b = 1, boxes
      if (.not. jammed(b)) cycle
      interval = min(count(motion%spheres%box == b), merge(33, 100, motion%worst > 0.03_wp))
      seen = 0
      do i = 1, size(kept)
        if (motion%spheres%box(i) /= b) cycle
        seen = seen + 1
        kept(i) = modulo(seen, interval) /= interval/2
      end do
    end do
    call keep(motion, kept)
  end subroutine take_out

  !> Which boxes hold a sphere that is not clear of another.
  subroutine find_jams(motion, jammed)
    type(motion_t), intent(in) :: motion
    logical, intent(out) :: jammed(0:)  !< by box

    type(pairs_t) :: overlaps
    integer :: i

    call find_pairs(motion%spheres, 2.0_wp*inflation*maxval(motion%spheres%radius), overlaps)
    jammed = .false.
    do i = 1, size(motion%number)
      associate (others => overlaps%with(overlaps%first(i):overlaps%first(i + 1) - 1))
        if (size(others) == 0) cycle
        jammed(motion%spheres%box(i)) = .true.
        jammed(motion%spheres%box(others)) = .true.
      end associate
    end do
  end subroutine find_jams

  !> Go on with some of the spheres only.
  pure subroutine keep(motion, kept)
    type(motion_t), intent(inout) :: motion
    logical, intent(in) :: kept(:)

    integer :: own(count(kept)), i

    own = pack([(i, i=1, size(kept))], kept)
    motion%spheres%position = motion%spheres%position(:, own)
    motion%spheres%radius = motion%spheres%radius(own)
    motion%spheres%box = motion%spheres%box(own)
    motion%number = motion%number(own)
    motion%lower = motion%lower(:, own)
    motion%upper = motion%upper(:, own)
    motion%listed = motion%listed(:, own)
    motion%velocity = motion%velocity(:, own)
    motion%force = motion%force(:, own)
    motion%inverse_mass = motion%inverse_mass(own)
  end subroutine keep

end module packing
