!> Graded axes: faces of segments, places counted in cells and back, images beyond periodic ends.
program test_grid_axis
  use check, only: expect, expect_close, finish
  use grid_axis, only: axis_t, uniform_axis, graded_axis, graded_faces
  use kinds, only: wp
  use mesh, only: mesh_t, new_mesh, new_uniform_mesh
  implicit none

  call segments()
  call places(.false.)
  call places(.true.)
  call halos()
  call sizes()
  call finish()

contains

  !> Two segments: widths 1, 2, 4 of 7 over 0.7 m, and four equal ones over 0.4 m.
  subroutine segments()
    real(wp) :: face(0:7)

    face = graded_faces([1.0_wp, 1.7_wp, 2.1_wp], [3, 4], [4.0_wp, 1.0_wp])
    call expect(all(abs(face - [1.0_wp, 1.1_wp, 1.3_wp, 1.7_wp, 1.8_wp, 1.9_wp, 2.0_wp, 2.1_wp]) < 1e-14_wp), &
                'widths of a segment grow by a constant factor from its first to its last')
    face(0:1) = graded_faces([1.0_wp, 1.7_wp], [1], [3.0_wp])
    call expect(all(abs(face(0:1) - [1.0_wp, 1.7_wp]) <= 0.0_wp), 'one cell fills its segment')
  end subroutine segments

  subroutine places(periodic)
    logical, intent(in) :: periodic

    type(axis_t) :: axis, even, same
    integer :: i
    real(wp) :: x, worst

    axis = graded_axis([0.0_wp, 0.1_wp, 0.3_wp, 0.7_wp], periodic)
    call expect(all(abs([(axis%in_cells(axis%face(i)), i=0, 2)] - [0, 1, 2]) < 1e-14_wp), 'faces are whole numbers of cells')
    call expect_close(axis%in_cells(0.2_wp), 1.5_wp, 1e-14_wp, 'a centre is half a cell')
    call expect_close(axis%in_cells(0.4_wp), 2.25_wp, 1e-14_wp, 'a quarter of the third cell')
    if (periodic) call expect_close(axis%in_cells(-0.3_wp), -0.75_wp, 1e-14_wp, 'an image of it below')
    if (periodic) call expect_close(axis%in_cells(0.8_wp), 4.0_wp, 1e-14_wp, 'an image of the first face above')
    if (.not. periodic) call expect_close(axis%in_cells(-0.05_wp), -0.5_wp, 1e-14_wp, 'beyond a wall, cells of the first width')
    if (.not. periodic) call expect_close(axis%in_cells(0.9_wp), 3.5_wp, 1e-14_wp, 'and of the last')
    worst = 0.0_wp
    even = uniform_axis(-0.2_wp, 0.5_wp, 7, periodic)
    same = graded_axis(even%face, periodic)
    do i = -20, 90
      x = 0.011_wp*i
      worst = max(worst, abs(axis%in_metres(axis%in_cells(x)) - x), abs(even%in_metres(even%in_cells(x)) - x), &
                  abs(even%in_cells(x) - same%in_cells(x)))
    end do
    call expect_close(worst, 0.0_wp, 1e-13_wp, 'in_metres reverses in_cells; equal cells may be given as graded ones')
  end subroutine places

  !> Widths beyond the ends are those of mirror images at a wall, and of images where the ends are joined.
  subroutine halos()
    type(axis_t) :: axis

    axis = graded_axis([0.0_wp, 1.0_wp, 3.0_wp, 7.0_wp], .false.)
    call expect(all(abs(axis%width - [2, 1, 1, 2, 4, 4, 2]) < 1e-14_wp), 'mirror images')
    call expect(all(abs(axis%gap - [1.5_wp, 1.0_wp, 1.5_wp, 3.0_wp, 4.0_wp, 3.0_wp]) < 1e-14_wp), 'distances of centres')
    axis = graded_axis([0.0_wp, 1.0_wp, 3.0_wp, 7.0_wp], .true.)
    call expect(all(abs(axis%width - [2, 4, 1, 2, 4, 1, 2]) < 1e-14_wp), 'images')
  end subroutine halos

  subroutine sizes()
    type(mesh_t) :: mesh

    mesh = new_uniform_mesh([0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 2.0_wp, 3.0_wp], [2, 2, 2], [.false., .false., .false.])
    call expect(mesh%uniform, 'a uniform mesh says so')
    mesh = new_mesh([mesh%axis(1), graded_axis([0.0_wp, 0.5_wp, 2.0_wp], .false.), mesh%axis(3)])
    call expect(.not. mesh%uniform, 'and a graded one')
    call expect_close(sum(mesh%volumes([1, 1, 1], [2, 2, 2])), 6.0_wp, 1e-14_wp, 'volumes fill the domain')
    call expect_close(sum(mesh%areas(1, [1, 1, 1], [1, 2, 2])), 6.0_wp, 1e-14_wp, 'faces across x fill a section')
    call expect_close(sum(mesh%areas(2, [1, 1, 1], [2, 1, 2])), 3.0_wp, 1e-14_wp, 'and across y')
    call expect(all(abs(mesh%coarsest - [0.5_wp, 1.5_wp, 1.5_wp]) < 1e-14_wp), 'the widest cells')
  end subroutine sizes

end program test_grid_axis
