!> Spheres placed without overlap: loose and dense, equal and not, walls and periodic faces, obstacles, too many.
program test_packing
  use check, only: expect, finish
  use constants, only: pi
  use kinds, only: wp
  use packing, only: box_t, pack_spheres, has_overlap
  use random_numbers, only: random_t, new_random
  use sphere_pairs, only: spheres_t, pairs_t, find_pairs
  use text, only: shown
  use vessel, only: vessel_t
  implicit none

  call pairs_found()
  call pack_box('loose, equal', 2000, 0.30_wp, 1.0_wp, .false.)
  call pack_box('poured, equal', 2000, 0.55_wp, 1.0_wp, .false.)
  call pack_box('dense, equal', 1000, 0.58_wp, 1.0_wp, .true.)
  call pack_box('very dense, equal', 1000, 0.60_wp, 1.0_wp, .true.)
  call pack_box('loose, 1:3', 2000, 0.30_wp, 3.0_wp, .true.)
  call pack_box('dense, 1:3', 2000, 0.60_wp, 3.0_wp, .true.)
  call pack_box('1:8', 3000, 0.50_wp, 8.0_wp, .false.)
  call pack_box('a few', 3, 0.20_wp, 1.0_wp, .false.)
  call pack_box('one', 1, 0.20_wp, 1.0_wp, .false.)
  call pack_box('none', 0, 0.20_wp, 1.0_wp, .false.)
  call layer()
  call two_boxes()
  call obstacle()
  call too_many()
  call finish()

contains

  !> n spheres with radii between 1 mm and `ratio` mm, in a cube of which they take the share `fraction`.
  subroutine make_cube(n, fraction, ratio, periodic, spheres, box)
    integer, intent(in) :: n
    real(wp), intent(in) :: fraction, ratio
    logical, intent(in) :: periodic
    type(spheres_t), intent(out) :: spheres
    type(box_t), intent(out) :: box

    type(random_t) :: random
    real(wp) :: volume
    integer :: i

    random = new_random(3, 1)
    allocate (spheres%position(3, n), source=0.0_wp)
    allocate (spheres%box(n), source=1)
    allocate (spheres%radius(n))
    do i = 1, n
      spheres%radius(i) = 1.0e-3_wp*ratio**random%uniform()
    end do
    volume = 4.0_wp/3.0_wp*pi*max(sum(spheres%radius**3), 1.0e-9_wp)/fraction
    box = box_t([0.1_wp, -0.2_wp, 0.3_wp], [0.1_wp, -0.2_wp, 0.3_wp] + volume**(1.0_wp/3.0_wp), spread(periodic, 1, 3))
    spheres%vessel = vessel_t(box%lower, box%upper, box%spans)
  end subroutine make_cube

  !> The deepest overlap of any two spheres, over the sum of their radii, found by looking at all of them.
  function deepest_overlap(spheres) result(deepest)
    type(spheres_t), intent(in) :: spheres
    real(wp) :: deepest

    integer :: i, j

    deepest = -1.0_wp
    do i = 1, size(spheres%radius)
      do j = 1, i - 1
        deepest = max(deepest, 1.0_wp - norm2(spheres%vessel%shortest(spheres%position(:, i) - spheres%position(:, j)))/ &
                      (spheres%radius(i) + spheres%radius(j)))
      end do
    end do
  end function deepest_overlap

  !> Whether all spheres of a box lie in it with their surfaces, but through periodic faces.
  function inside(spheres, box, number) result(all_inside)
    type(spheres_t), intent(in) :: spheres
    type(box_t), intent(in) :: box
    integer, intent(in) :: number
    logical :: all_inside

    real(wp) :: margin(3)
    integer :: i

    all_inside = .true.
    do i = 1, size(spheres%radius)
      if (spheres%box(i) /= number) cycle
      margin = merge(0.0_wp, spheres%radius(i), box%spans) - 1.0e-15_wp
      all_inside = all_inside .and. all(spheres%position(:, i) >= box%lower + margin) &
        .and. all(spheres%position(:, i) <= box%upper - margin)
    end do
  end function inside

  subroutine pack_box(name, n, fraction, ratio, periodic)
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    real(wp), intent(in) :: fraction, ratio
    logical, intent(in) :: periodic

    type(spheres_t) :: spheres
    type(box_t) :: box
    type(random_t) :: random
    logical, allocatable :: placed(:)

    call make_cube(n, fraction, ratio, periodic, spheres, box)
    random = new_random(1, 0)
    call pack_spheres([box], random, spheres, placed)
    call expect(all(placed), name//': all '//shown(n)//' spheres find a place at '//shown(fraction))
    call expect(deepest_overlap(spheres) < 0.0_wp, name//': none of them overlap')
    call expect(.not. has_overlap(spheres), name//': and the cells find none either')
    call expect(inside(spheres, box, 1), name//': all inside')
  end subroutine pack_box

  !> The list of pairs against all pairs.
  subroutine pairs_found()
    type(spheres_t) :: spheres
    type(box_t) :: box
    type(pairs_t) :: pairs
    type(random_t) :: random
    integer :: i, j, near, walls

    random = new_random(2, 0)
    do walls = 0, 1
      call make_cube(400, 0.4_wp, 5.0_wp, walls == 0, spheres, box)
      near = 0
      do i = 1, size(spheres%radius)
        spheres%position(:, i) = box%lower + (box%upper - box%lower)*[random%uniform(), random%uniform(), random%uniform()]
        do j = 1, i - 1
          if (norm2(spheres%vessel%shortest(spheres%position(:, i) - spheres%position(:, j))) < &
            spheres%radius(i) + spheres%radius(j) + 2.0e-4_wp) near = near + 1
        end do
      end do
      call find_pairs(spheres, 2.0e-4_wp, pairs)
      call expect(near > 400 .and. pairs%first(401) - 1 == near, 'as many pairs as looking at all: '//shown(near))
      call expect(has_overlap(spheres), 'spheres thrown in overlap')
    end do
  end subroutine pairs_found

  !> A box as thin as its spheres.
  subroutine layer()
    type(spheres_t) :: spheres
    type(box_t) :: box
    type(random_t) :: random
    logical, allocatable :: placed(:)
    integer, parameter :: n = 200

    spheres%vessel = vessel_t([0.0_wp, 0.0_wp, 0.0_wp], [40.0_wp, 12.0_wp, 1.0_wp], [.false., .false., .false.])
    allocate (spheres%position(3, n), source=0.0_wp)
    allocate (spheres%radius(n), source=0.5_wp)
    allocate (spheres%box(n), source=1)
    box = box_t(spheres%vessel%lower, spheres%vessel%upper, [.false., .false., .false.])
    random = new_random(1, 0)
    call pack_spheres([box], random, spheres, placed)
    call expect(all(placed), 'one layer: all find a place')
    call expect(deepest_overlap(spheres) < 0.0_wp, 'one layer: none overlap')
    call expect(all(abs(spheres%position(3, :) - 0.5_wp) <= 0.0_wp), 'one layer: all in its middle')
  end subroutine layer

  !> Two powders in one box, a third partly in it: all are clear of each other and each in its own.
  subroutine two_boxes()
    integer, parameter :: n = 900
    type(spheres_t) :: spheres
    type(box_t) :: boxes(3)
    type(random_t) :: random
    logical, allocatable :: placed(:)
    integer :: i

    spheres%vessel = vessel_t([0.0_wp, 0.0_wp, 0.0_wp], [20.0_wp, 20.0_wp, 10.0_wp], [.false., .false., .false.])
    boxes(1) = box_t([0.0_wp, 0.0_wp, 0.0_wp], [10.0_wp, 10.0_wp, 10.0_wp], [.false., .false., .false.])
    boxes(2) = boxes(1)
    boxes(3) = box_t([5.0_wp, 5.0_wp, 0.0_wp], [20.0_wp, 20.0_wp, 10.0_wp], [.false., .false., .false.])
    allocate (spheres%position(3, n), source=0.0_wp)
    allocate (spheres%radius(n), source=[(0.3_wp, i=1, 300), (0.5_wp, i=301, 600), (0.6_wp, i=601, 900)])
    allocate (spheres%box(n), source=[(1, i=1, 300), (2, i=301, 600), (3, i=601, 900)])
    random = new_random(1, 0)
    call pack_spheres(boxes, random, spheres, placed)
    call expect(all(placed), 'boxes that share space: all find a place')
    call expect(deepest_overlap(spheres) < 0.0_wp, 'boxes that share space: none overlap')
    do i = 1, 3
      call expect(inside(spheres, boxes(i), i), 'boxes that share space: each in its own')
    end do
  end subroutine two_boxes

  !> A large sphere that is already there stays where it is.
  subroutine obstacle()
    type(spheres_t) :: spheres
    type(box_t) :: box
    type(random_t) :: random
    logical, allocatable :: placed(:)
    real(wp) :: middle(3)

    call make_cube(800, 0.3_wp, 2.0_wp, .false., spheres, box)
    middle = 0.5_wp*(box%lower + box%upper)
    spheres%box(1) = 0
    spheres%radius(1) = 0.25_wp*(box%upper(1) - box%lower(1))
    spheres%position(:, 1) = middle
    random = new_random(1, 0)
    call pack_spheres([box], random, spheres, placed)
    call expect(all(placed), 'round an obstacle: all find a place')
    call expect(deepest_overlap(spheres) < 0.0_wp, 'round an obstacle: none overlap')
    call expect(all(abs(spheres%position(:, 1) - middle) <= 0.0_wp), 'the obstacle has not moved')
  end subroutine obstacle

  !> What does not fit is left out and told; what is placed is placed well. A box with room beside it is full.
  subroutine too_many()
    type(spheres_t) :: spheres, rest
    type(box_t) :: box
    type(random_t) :: random
    logical, allocatable :: placed(:)
    real(wp) :: fraction

    call make_cube(1000, 0.80_wp, 1.0_wp, .true., spheres, box)
    random = new_random(1, 0)
    call pack_spheres([box], random, spheres, placed)
    fraction = 0.80_wp*count(placed)/1000
    call expect(fraction > 0.60_wp .and. fraction < 0.67_wp, 'of too many spheres '//shown(fraction)//' of the box are placed')
    rest = spheres_t(spheres%vessel, reshape(pack(spheres%position, spread(placed, 1, 3)), [3, count(placed)]), &
                     pack(spheres%radius, placed), pack(spheres%box, placed))
    call expect(deepest_overlap(rest) < 0.0_wp, 'and none of these overlap')
  end subroutine too_many

end program test_packing
